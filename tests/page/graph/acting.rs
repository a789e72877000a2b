//! What a person does with the graph.

use motorlink_messages::bus::{Command, StopReason};
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::Element;

use super::{bench, canvas, graph, is_drawn, name, report, steady};
use crate::{
    bench::{pause, press},
    language::choose,
};

#[wasm_bindgen_test]
async fn the_graph_and_its_controls_are_found_by_their_names() {
    let bench = bench("graph-names").await;
    bench.find("region", "Speed and current");
    bench.find("img", "Speed and current, last 10 s");
    bench.find("checkbox", "Symmetric");
    bench.find("radiogroup", "Window");
    for window in ["10 s", "60 s", "5 min"] {
        bench.find("radio", window);
    }
    for trace in ["speed", "current", "target", "temperature", "position"] {
        bench.find("checkbox", &format!("Show {trace}"));
    }
    for button in ["Pause", "Now", "PNG", "Save SVG"] {
        bench.find("button", button);
    }
    bench.find("status", "Crosshair");
}

#[wasm_bindgen_test]
async fn keys_zoom_pan_and_still_stop_and_drive() {
    let bench = bench("graph-keys").await;
    report(&bench, steady(40_000, 100));
    graph(&bench).focus().unwrap();
    press("+");
    bench
        .until("the zoom", || name(&bench) == "Speed and current, last 8 s")
        .await;
    press("-");
    bench.find("radio", "10 s").click();
    let live = "Speed and current, last 10 s";
    bench.until("10 s", || name(&bench) == live).await;
    graph(&bench).focus().unwrap();
    press("Home");
    bench
        .until("the oldest", || name(&bench).contains("up to"))
        .await;
    press("End");
    bench.until("now", || name(&bench) == live).await;
    assert_eq!(bench.commands().await, []);

    press("ArrowLeft");
    press("2");
    press(" ");
    press("Escape");
    let commands = bench.commands().await;
    let stop = Command::StopAll(StopReason::Operator);
    assert!(matches!(commands[0], Command::Start { .. }), "{commands:?}");
    assert_eq!(commands[1..], [stop, stop]);
}

#[wasm_bindgen_test]
async fn while_paused_the_arrow_keys_read_values() {
    let bench = bench("graph-crosshair").await;
    report(&bench, steady(40_000, 123));
    bench.until("a line", || is_drawn(&canvas(&bench))).await;
    bench.click("Pause");
    bench
        .until("the pause", || name(&bench).contains("up to"))
        .await;
    graph(&bench).focus().unwrap();
    press("ArrowLeft");
    let values = bench.find("status", "Crosshair");
    let shown = |values: &Element| !values.class_list().contains("absent");
    bench.until("the values", || shown(&values)).await;
    let text = bench.text("status", "Crosshair");
    assert!(text.contains("Speed +123 rpm"), "{text}");
    assert!(text.contains("Current 0.00 A"), "{text}");
    // By keys, it is read aloud.
    assert_eq!(values.get_attribute("aria-live").unwrap(), "polite");
}

/// The page has one graph, whichever language it is drawn in.
#[wasm_bindgen_test]
async fn a_change_of_language_keeps_the_crosshair() {
    let bench = bench("graph-language").await;
    report(&bench, steady(40_000, 123));
    bench.until("a line", || is_drawn(&canvas(&bench))).await;
    bench.click("Pause");
    bench
        .until("the pause", || name(&bench).contains("up to"))
        .await;
    graph(&bench).focus().unwrap();
    press("ArrowLeft");
    for (list, language, stop) in [
        ("Language", "de", "STOP, alle Motoren"),
        ("Sprache", "en", "STOP all motors"),
    ] {
        choose(&bench, list, language);
        bench
            .until(stop, || !bench.find_all("button", stop).is_empty())
            .await;
    }
    bench
        .until("the values", || {
            let values = bench.find("status", "Crosshair");
            !values.class_list().contains("absent")
        })
        .await;
    let text = bench.text("status", "Crosshair");
    assert!(text.contains("Speed +123 rpm"), "{text}");
}

#[wasm_bindgen_test]
async fn the_newest_values_are_there_in_words() {
    let bench = bench("graph-words").await;
    let words = bench.find("region", "Speed and current");
    let words = words.query_selector("#graph-words").unwrap().unwrap();
    // They are not said again more often than every few seconds.
    for _ in 0..60 {
        report(&bench, steady(100, 123));
        pause(100).await;
        let said = words.text_content().unwrap_or_default();
        if said == "Now: speed +123 rpm, current 0.00 A, target –." {
            return;
        }
    }
    panic!("{:?}", words.text_content());
}
