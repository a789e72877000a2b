//! What is on the canvas, and when it is drawn.

use js_sys::{Array, Function, Promise};
use motorlink_messages::{
    bus::Activity,
    protocol::{Rpm, Setpoint, SpeedTarget},
};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, HtmlCanvasElement};

use super::{
    PropertyOverride, bench, canvas, colour_of, context, is_drawn, name, pane, report,
    report_activity, rows_of, steady, wipe,
};
use crate::bench::{document, pause};

#[wasm_bindgen_test]
async fn what_was_reported_is_drawn_in_the_colour_of_its_trace_with_every_spike() {
    let bench = bench("graph-drawn").await;
    let canvas = canvas(&bench);
    let speed = colour_of(&bench, "--speed");
    let mut samples = steady(9_000, 100);
    let middle = samples.len() / 2;
    samples[middle].reply.speed = Some(Rpm::new(300));
    report(&bench, samples);
    let current = colour_of(&bench, "--current");
    bench
        .until("both lines", || {
            [speed, current].map(|colour| !rows_of(&canvas, colour, 20).is_empty()) == [true; 2]
        })
        .await;
    // The upper pane, from 350 down to 50.
    let (top, height) = pane(&canvas, 0, 2);
    let line = rows_of(&canvas, speed, 20)[0];
    assert!(
        line.abs_diff(top + height * 5 / 6) <= 2,
        "{line} of {height}"
    );
    let spike = rows_of(&canvas, speed, 1)[0];
    assert!(spike.abs_diff(top + height / 6) <= 2, "{spike} of {height}");
    // The current has a pane of its own below, from 0.1 to -0.1.
    let (top, height) = pane(&canvas, 1, 2);
    let line = rows_of(&canvas, current, 20)[0];
    assert!(line.abs_diff(top + height / 2) <= 2, "{line} of {height}");
}

#[wasm_bindgen_test]
async fn a_trace_that_is_switched_off_is_gone() {
    let bench = bench("graph-traces").await;
    let canvas = canvas(&bench);
    report(&bench, steady(9_000, 100));
    let speed = colour_of(&bench, "--speed");
    let seen = || !rows_of(&canvas, speed, 20).is_empty();
    bench.until("the line", seen).await;
    bench.find("checkbox", "Show speed").click();
    bench.until("the line to go", || !seen()).await;
    bench.find("checkbox", "Show speed").click();
    bench.until("the line to come back", seen).await;
}

#[wasm_bindgen_test]
async fn on_a_screen_of_twice_the_density_the_canvas_has_twice_the_pixels() {
    let bench = bench("graph-density").await;
    let canvas = canvas(&bench);
    bench.until("a size", || canvas.width() > 400).await;
    let (width, height) = (canvas.width(), canvas.height());
    let shown = canvas.get_bounding_client_rect().width();
    let window: JsValue = web_sys::window().unwrap().into();
    let density = PropertyOverride::new(&window, "devicePixelRatio", &2.into());
    let resize = || {
        let resize = Event::new("resize").unwrap();
        web_sys::window().unwrap().dispatch_event(&resize).unwrap();
    };
    resize();
    bench
        .until("twice the pixels", || canvas.width() > width + 100)
        .await;
    assert!(canvas.width().abs_diff(2 * width) <= 1);
    assert!(canvas.height().abs_diff(2 * height) <= 1);
    assert!((canvas.get_bounding_client_rect().width() - shown).abs() <= 1.0);
    drop(density);
    resize();
    bench.until("one again", || canvas.width() == width).await;
}

#[wasm_bindgen_test]
async fn a_hidden_page_draws_nothing_and_loses_nothing() {
    let bench = bench("graph-hidden").await;
    let canvas = canvas(&bench);
    report(&bench, steady(5_000, 100));
    bench.until("a line", || is_drawn(&canvas)).await;
    let changed = || {
        let changed = Event::new("visibilitychange").unwrap();
        document().dispatch_event(&changed).unwrap();
    };
    let hidden = PropertyOverride::new(&document().into(), "hidden", &true.into());
    changed();
    wipe(&canvas);
    for _ in 0..5 {
        report(&bench, steady(20, 300));
        pause(100).await;
    }
    assert!(!is_drawn(&canvas));
    drop(hidden);
    changed();
    let speed = colour_of(&bench, "--speed");
    bench.until("a line", || is_drawn(&canvas)).await;
    // What came meanwhile has had the scale grow.
    let lines = rows_of(&canvas, speed, 2);
    assert!(
        lines[0] < 8 + (canvas.height() as usize - 30) / 6,
        "{lines:?}"
    );
}

#[wasm_bindgen_test]
async fn a_paused_graph_stands_still_and_goes_on_where_the_time_is() {
    let bench = bench("graph-paused").await;
    let canvas = canvas(&bench);
    report(&bench, steady(5_000, 100));
    bench.until("a line", || is_drawn(&canvas)).await;
    bench.click("Pause");
    bench
        .until("the name of a paused graph", || {
            name(&bench).contains("up to")
        })
        .await;
    // It is drawn once more when the last replies must have come.
    pause(700).await;
    wipe(&canvas);
    for _ in 0..4 {
        report(&bench, steady(20, 100));
        pause(100).await;
    }
    assert!(!is_drawn(&canvas));
    bench.click("Resume");
    bench.until("a line", || is_drawn(&canvas)).await;
    assert_eq!(name(&bench), "Speed and current, last 10 s");
}

#[wasm_bindgen_test]
async fn without_news_an_empty_graph_is_not_drawn() {
    let bench = bench("graph-empty").await;
    let canvas = canvas(&bench);
    bench.until("a size", || canvas.width() > 400).await;
    pause(200).await;
    let context = context(&canvas);
    context.fill_rect(2_000.0, 400.0, 400.0, 400.0);
    assert!(is_drawn(&canvas));
    pause(400).await;
    assert!(is_drawn(&canvas), "somebody has drawn, and wiped before");
    report(&bench, steady(1_000, 100));
    let speed = colour_of(&bench, "--speed");
    bench
        .until("a line", || !rows_of(&canvas, speed, 2).is_empty())
        .await;
}

/// How often the lines are drawn in 60 frames of the screen, and how many steps of 50 ms these last.
async fn drawings_and_steps(canvas: &HtmlCanvasElement) -> [f64; 2] {
    let count = Function::new_with_args(
        "context",
        "let drawings = 0;
         context.clearRect = (...area) => {
             drawings += 1;
             CanvasRenderingContext2D.prototype.clearRect.apply(context, area);
         };
         let left = 60;
         const begun = performance.now();
         return new Promise((done) => requestAnimationFrame(function next() {
             left -= 1;
             if (left > 0) requestAnimationFrame(next);
             else done([drawings, (performance.now() - begun) / 50]);
         }));",
    );
    let promise = count.call1(&JsValue::UNDEFINED, &context(canvas)).unwrap();
    let counted = JsFuture::from(promise.unchecked_into::<Promise>()).await;
    let counted: Array = counted.unwrap().unchecked_into();
    [0, 1].map(|place| counted.get(place).as_f64().unwrap())
}

#[wasm_bindgen_test]
async fn a_graph_is_drawn_in_every_frame_once_a_motor_is_driven() {
    let bench = bench("graph-at-rest").await;
    // In a narrow one a column lasts longer than a frame.
    let panel = bench.find("region", "Speed and current");
    panel.style().set_property("width", "1200px").unwrap();
    let canvas = canvas(&bench);
    bench.until("its width", || canvas.width() > 800).await;
    report(&bench, steady(5_000, 0));
    bench.until("a line", || is_drawn(&canvas)).await;
    let [drawings, steps] = drawings_and_steps(&canvas).await;
    assert!(
        (steps / 3.0..steps + 3.0).contains(&drawings),
        "{drawings}, {steps} steps"
    );

    let setpoint = Setpoint::velocity(SpeedTarget::new(100).unwrap());
    for activity in [Activity::Driven { setpoint }, Activity::Idle] {
        report_activity(&bench, activity, steady(5_000, 0));
        // A busy computer has no more frames than steps.
        let mut counted = [0.0; 2];
        for _ in 0..10 {
            counted = drawings_and_steps(&canvas).await;
            if counted[0] > counted[1] + 10.0 {
                break;
            }
        }
        let [drawings, steps] = counted;
        assert!(
            drawings > steps + 10.0,
            "{drawings}, {steps} steps; {activity:?}"
        );
    }
}

#[wasm_bindgen_test]
async fn another_theme_has_other_colours() {
    let bench = bench("graph-theme").await;
    let canvas = canvas(&bench);
    report(&bench, steady(9_000, 100));
    let drawn = || {
        let speed = colour_of(&bench, "--speed");
        !rows_of(&canvas, speed, 20).is_empty()
    };
    bench.until("a line", drawn).await;
    let mut colours = Vec::new();
    // All the way round, as it was before.
    for _ in 0..3 {
        bench.click("Theme");
        pause(100).await;
        bench
            .until("a line in the colours of the theme", drawn)
            .await;
        colours.push(colour_of(&bench, "--speed"));
    }
    colours.dedup();
    assert!(colours.len() > 1, "every theme has the same colours");
}
