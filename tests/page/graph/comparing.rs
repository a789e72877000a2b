//! One trace of several motors.

use motorlink_messages::protocol::Rpm;
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, EventInit, HtmlElement, HtmlInputElement, HtmlSelectElement, Storage};

use super::{Page, bench, canvas, graph, name, report, rows_of, steady};
use crate::{
    bench::{document, pause, press, text_of},
    tools::id,
};

fn storage() -> Storage {
    web_sys::window().unwrap().local_storage().unwrap().unwrap()
}

/// A page with this many motors, the first of which has a name: motor n has run at 30 n rpm for so long.
async fn motors(test: &str, count: u8) -> Page {
    let fleet = "1\tno\tnone\tFront <left>\n";
    storage().set_item("motorlink.fleet", fleet).unwrap();
    let bench = bench(test).await;
    storage().remove_item("motorlink.fleet").unwrap();
    run(&bench, count, 9_000);
    bench
}

/// All of it arrives at once: a graph that has drawn some of the motors keeps their scale while the others fit it.
fn run(bench: &Page, count: u8, long_ms: u64) {
    let at_rest = steady(long_ms, 0);
    let of_all = (1..=count).flat_map(|of| {
        at_rest.iter().copied().map(move |mut sample| {
            sample.reply.id = id(of);
            sample.reply.speed = Some(Rpm::new(30 * i16::from(of)));
            sample
        })
    });
    report(bench, of_all.collect());
}

fn compare(bench: &Page, what: &str) {
    let list: HtmlSelectElement = bench.find("combobox", "Compare").unchecked_into();
    list.set_value(what);
    let init = EventInit::new();
    init.set_bubbles(true);
    let change = Event::new_with_event_init_dict("change", &init).unwrap();
    list.dispatch_event(&change).unwrap();
}

/// The items of the legend: what they say, and their colour.
fn legend(bench: &Page) -> Vec<(String, [u8; 3])> {
    let panel = bench.find("region", "Speed and current");
    let items = panel
        .query_selector_all(".graph-legend li:not([hidden])")
        .unwrap();
    let item = |place| {
        let item: HtmlElement = items.get(place).unwrap().unchecked_into();
        let style = web_sys::window().unwrap().get_computed_style(&item);
        let colour = style.unwrap().unwrap().get_property_value("color").unwrap();
        let digits = colour.trim_start_matches("rgb(").trim_end_matches(')');
        let parts: Vec<u8> = digits
            .split(", ")
            .map(|part| part.parse().unwrap())
            .collect();
        let name = item.query_selector("span").unwrap().unwrap();
        (text_of(name.unchecked_ref()), parts.try_into().unwrap())
    };
    (0..items.length()).map(item).collect()
}

#[wasm_bindgen_test]
async fn every_motor_has_its_line_in_the_colour_of_the_legend() {
    let bench = motors("graph-compare", 8).await;
    let canvas = canvas(&bench);
    let compares = || !bench.find_all("list", "Motors compared").is_empty();
    assert!(!compares());
    compare(&bench, "speed");
    bench
        .until("the legend", || legend(&bench).len() == 8)
        .await;
    assert!(compares());
    let legend = legend(&bench);
    assert_eq!(legend[0].0, "0x01 Front <left>");
    assert_eq!(legend[7].0, "0x08");
    for (motor, (_, colour)) in (1..).zip(&legend) {
        // From 300 at the top to 0: 30 rpm are a tenth. The desk may still give the canvas another height.
        let is_drawn = || {
            let height = canvas.height() as usize - 30;
            let wanted = 8 + height * (10 - motor) / 10;
            let line = rows_of(&canvas, *colour, 60);
            line.first().is_some_and(|row| row.abs_diff(wanted) <= 3)
        };
        bench.until("its line at its speed", is_drawn).await;
    }
    assert_eq!(name(&bench), "Speed of each motor, last 10 s");
    let speed: HtmlInputElement = bench.find("checkbox", "Show speed").unchecked_into();
    assert!(speed.disabled());

    compare(&bench, "");
    bench.until("one motor", || !compares()).await;
    assert!(!speed.disabled());
    assert_eq!(name(&bench), "Speed and current, last 10 s");
}

#[wasm_bindgen_test]
async fn the_crosshair_and_the_words_tell_every_motor() {
    let bench = motors("graph-compare-words", 3).await;
    compare(&bench, "speed");
    bench.click("Pause");
    bench
        .until("the pause", || name(&bench).contains("up to"))
        .await;
    graph(&bench).focus().unwrap();
    press("ArrowLeft");
    let wanted = "0x01 Front <left> +30 rpm0x02 +60 rpm0x03 +90 rpm";
    bench
        .until("the values", || {
            bench.text("status", "Crosshair").ends_with(wanted)
        })
        .await;
    bench.click("Resume");
    let panel = bench.find("region", "Speed and current");
    let words = panel.query_selector("#graph-words").unwrap().unwrap();
    let wanted = "Now: speed: 0x01 Front <left> +30 rpm, 0x02 +60 rpm, 0x03 +90 rpm.";
    for _ in 0..60 {
        run(&bench, 3, 100);
        pause(100).await;
        if words.text_content().unwrap_or_default() == wanted {
            return;
        }
    }
    panic!("{:?}", words.text_content());
}

#[wasm_bindgen_test]
async fn beyond_eight_motors_it_is_said_that_there_are_more() {
    let bench = motors("graph-compare-more", 11).await;
    compare(&bench, "temperature");
    // The motors report one after the other.
    let said = || legend(&bench).get(8).map(|last| last.0.clone());
    let wanted = Some("and 3 more, not shown".to_owned());
    bench.until("the legend", || said() == wanted).await;
}

#[wasm_bindgen_test]
async fn a_name_that_is_given_in_the_strip_is_in_the_legend() {
    let bench = motors("graph-compare-named", 2).await;
    compare(&bench, "speed");
    bench
        .until("the legend", || legend(&bench).len() == 2)
        .await;
    bench.click("Name and side of motor 0x01");
    let name = || bench.find_all("textbox", "Name").into_iter().next();
    bench
        .until("the focus in the name", || {
            name().is_some_and(|name| document().active_element() == Some(name.into()))
        })
        .await;
    let name: HtmlInputElement = name().unwrap().unchecked_into();
    assert_eq!(name.value(), "Front <left>");
    name.set_value("Rear");
    press("Enter");
    bench
        .until("the name", || legend(&bench)[0].0 == "0x01 Rear")
        .await;
    storage().remove_item("motorlink.fleet").unwrap();
}
