//! Zoom by a box, by the wheel over a value axis and by keys, the second cursor, and the marks.

use js_sys::Function;
use motorlink_messages::{
    Adapter, Connection, ToPage, Update,
    bus::Activity,
    protocol::{Instant, Mode, Setpoint, SpeedTarget},
};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{HtmlElement, PointerEvent, PointerEventInit};

use super::{
    Page, bench, canvas, colour_of, graph, is_drawn, name, now_ms, pane, report, rows_of, sample,
    steady,
};
use crate::bench::{motor, press};

/// Where an event is: the part of the plot's width, and the row of the canvas.
fn place(bench: &Page, (part, row): (f64, f64)) -> (i32, i32) {
    let graph = graph(bench).get_bounding_client_rect();
    let plot_width = graph.width() - 76.0 - 36.0;
    let x = graph.left() + 76.0 + part * plot_width;
    #[allow(clippy::cast_possible_truncation, reason = "a place on the screen")]
    let whole = |pixels: f64| pixels.round() as i32;
    (whole(x), whole(graph.top() + row))
}

fn point(bench: &Page, name: &str, at: (f64, f64), shift: bool) {
    let (x, y) = place(bench, at);
    let init = PointerEventInit::new();
    init.set_client_x(x);
    init.set_client_y(y);
    init.set_shift_key(shift);
    init.set_bubbles(true);
    let event = PointerEvent::new_with_event_init_dict(name, &init).unwrap();
    graph(bench).dispatch_event(&event).unwrap();
}

fn drag(bench: &Page, from: (f64, f64), to: (f64, f64), shift: bool) {
    point(bench, "pointerdown", from, shift);
    point(bench, "pointermove", to, shift);
    point(bench, "pointerup", to, shift);
}

/// The row of the line of the speed.
fn line(bench: &Page) -> Option<usize> {
    let speed = colour_of(bench, "--speed");
    rows_of(&canvas(bench), speed, 20).first().copied()
}

fn row(row: usize) -> f64 {
    f64::from(u32::try_from(row).unwrap())
}

/// A line at 100 in the middle of its pane.
async fn paused(test: &str) -> (Page, usize, usize) {
    let bench = bench(test).await;
    report(&bench, steady(9_000, 100));
    bench.until("a line", || line(&bench).is_some()).await;
    bench.click("Pause");
    bench
        .until("the pause", || name(&bench).contains("up to"))
        .await;
    let (top, height) = pane(&canvas(&bench), 0, 2);
    assert!(line(&bench).unwrap().abs_diff(top + height / 2) <= 2);
    (bench, top, height)
}

#[wasm_bindgen_test]
async fn a_drag_with_shift_zooms_to_its_box_and_fit_shows_all_values_again() {
    let (bench, top, height) = paused("graph-box").await;
    // The upper half and a little more, in half of the time.
    let (from, to) = ((0.25, row(top)), (0.75, row(top + height * 3 / 4)));
    drag(&bench, from, to, true);
    bench
        .until("half of the time", || {
            name(&bench).starts_with("Speed and current, 5 s up to")
        })
        .await;
    let lower = top + height * 2 / 3;
    let is_lower = || line(&bench).is_some_and(|line| line.abs_diff(lower) <= 3);
    bench.until("the line further down", is_lower).await;
    let fit: HtmlElement = bench.find("button", "Fit");
    assert!(!fit.has_attribute("disabled"));
    fit.click();
    let is_fitted = || line(&bench).is_some_and(|line| line.abs_diff(top + height / 2) <= 2);
    bench.until("the line in the middle", is_fitted).await;
    bench
        .until("nothing to fit", || fit.has_attribute("disabled"))
        .await;

    // Without Shift a drag pans, unless the switch is on.
    bench.find("checkbox", "Box zoom").click();
    drag(&bench, (0.5, row(top + 3)), (1.0, row(top + 5)), false);
    bench
        .until("the time alone", || {
            name(&bench).starts_with("Speed and current, 2.5 s up to")
        })
        .await;
    assert!(fit.has_attribute("disabled"));
}

#[wasm_bindgen_test]
async fn the_wheel_over_the_axis_and_keys_zoom_the_values() {
    let (bench, top, height) = paused("graph-value-zoom").await;
    let span = name(&bench);
    let (_, y) = place(&bench, (0.0, row(top)));
    let turn = Function::new_with_args(
        "graph, y",
        "const clientX = graph.getBoundingClientRect().left + 20; \
         graph.dispatchEvent(new WheelEvent('wheel', \
             { clientX, clientY: y, deltaY: -100, bubbles: true, cancelable: true }))",
    );
    for _ in 0..2 {
        turn.call2(&JsValue::NULL, &graph(&bench), &y.into())
            .unwrap();
    }
    // Around the upper edge twice to 80 %: the middle is lower by 0.5 / 0.64.
    let lower = top + height * 78 / 100;
    let is_lower = || line(&bench).is_some_and(|line| line.abs_diff(lower) <= 3);
    bench.until("the line further down", is_lower).await;
    assert_eq!(name(&bench), span, "the time stays");
    graph(&bench).focus().unwrap();
    press("Backspace");
    let is_fitted = || line(&bench).is_some_and(|line| line.abs_diff(top + height / 2) <= 2);
    bench.until("the line in the middle", is_fitted).await;
    let fit = bench.find("button", "Fit");
    press("PageUp");
    bench
        .until("a zoom", || !fit.has_attribute("disabled"))
        .await;
}

#[wasm_bindgen_test]
async fn the_second_cursor_gives_the_difference_to_the_crosshair() {
    let bench = bench("graph-second").await;
    let now_ms = now_ms();
    let rising = (0..450).map(|step: u64| {
        let rpm = i16::try_from(step / 5).unwrap();
        sample(now_ms - 9_000 + 20 * step, rpm)
    });
    report(&bench, rising.collect());
    bench.until("a line", || is_drawn(&canvas(&bench))).await;
    bench.click("Pause");
    bench
        .until("the pause", || name(&bench).contains("up to"))
        .await;
    graph(&bench).focus().unwrap();
    press("ArrowLeft");
    bench.find("checkbox", "Second cursor").click();
    graph(&bench).focus().unwrap();
    press("ArrowRight");
    let text = || bench.text("status", "Crosshair");
    // A column is a fiftieth of a second or two, in which the speed hardly rises.
    bench
        .until("the difference", || {
            text().contains("Δt 0.0") && text().contains("(Δ ")
        })
        .await;
    // A click moves it.
    drag(&bench, (0.25, 60.0), (0.25, 60.0), false);
    point(&bench, "pointermove", (0.75, 60.0), false);
    bench
        .until("half of the time", || {
            let text = text();
            let has = |words: &str| text.contains(words);
            (has("Δt 4.9") || has("Δt 5.0"))
                && [49, 50, 51]
                    .iter()
                    .any(|rpm| has(&format!("(Δ +{rpm} rpm)")))
        })
        .await;
    bench.find("checkbox", "Second cursor").click();
    point(&bench, "pointermove", (0.7, 60.0), false);
    bench.until("no difference", || !text().contains('Δ')).await;
}

#[wasm_bindgen_test]
async fn the_crosshair_goes_from_mark_to_mark_and_says_their_words() {
    let bench = bench("graph-marks").await;
    report(&bench, steady(5_000, 0));
    let target = SpeedTarget::new(50).unwrap();
    let driven = Activity::Driven {
        setpoint: Setpoint::velocity(target),
    };
    for activity in [driven, Activity::Idle] {
        bench.post(&ToPage::Update(Update {
            now: Instant::from_millis(now_ms()),
            connection: Connection::Connected(Adapter::VIRTUAL),
            halted: false,
            motors: vec![motor(Mode::Velocity, activity)],
            job: None,
            raw: None,
            line: None,
            samples: vec![sample(now_ms(), 0)],
            notices: vec![],
        }));
        crate::bench::pause(400).await;
    }
    graph(&bench).focus().unwrap();
    let text = || bench.text("status", "Crosshair");
    press(",");
    bench.until("the stop", || text().contains(", Stop")).await;
    press(",");
    bench
        .until("the start", || text().contains(", Start: +50 rpm"))
        .await;
    press(".");
    bench
        .until("the stop again", || text().contains(", Stop"))
        .await;
    let values: HtmlElement = bench.find("status", "Crosshair").unchecked_into();
    assert_eq!(values.get_attribute("aria-live").unwrap(), "polite");
}
