//! The graph: a page with one in sight, what the motor tells it, and what is on its canvas.

mod acting;
mod comparing;
mod drawing;
mod kept;
mod replayed;
mod restored;
mod saving;
mod zooming;

use std::ops::Deref;

use js_sys::{Object, Reflect};
use motorlink_messages::{
    Adapter, Connection, ToPage, Update,
    bus::{Activity, Sample},
    protocol::{Current, Detail, Faults, Instant, Mode, MotorId, Position, Reply, Rpm},
};
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{CanvasRenderingContext2d, Element, HtmlCanvasElement, HtmlElement};

use crate::bench::{Bench, document, motor};

const ID: MotorId = MotorId::FIRST;

/// The style sheet as far as the graph needs it, in a panel of this size. It is in sight wherever the
/// rest of the page is: one that is not draws nothing.
const STYLE: &str = concat!(
    include_str!("../../../style/10-tokens.css"),
    include_str!("../../../style/20-base.css"),
    include_str!("../../../style/later/61-graph.css"),
    ".graph-panel { position: fixed; top: 0; left: 0; width: 700px; height: 300px; }",
);

/// A page with a motor and a graph that is 700 pixels wide.
struct Page {
    bench: Bench,
    style: Element,
}

impl Deref for Page {
    type Target = Bench;

    fn deref(&self) -> &Bench {
        &self.bench
    }
}

impl Drop for Page {
    /// The pages of other tests have looks of their own.
    fn drop(&mut self) {
        self.style.remove();
    }
}

async fn bench(name: &str) -> Page {
    let style = document().create_element("style").unwrap();
    style.set_text_content(Some(STYLE));
    document().head().unwrap().append_child(&style).unwrap();
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    let time_origin_ms = performance().time_origin() - WORKER_AGE_MS;
    bench.post(&ToPage::Hello { time_origin_ms });
    bench.received().await;
    Page { bench, style }
}

fn performance() -> web_sys::Performance {
    web_sys::window().unwrap().performance().unwrap()
}

/// The worker of these tests is this much older than their page, so that a page that has just begun
/// can be received of what was before.
const WORKER_AGE_MS: f64 = 50_000.0;

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "milliseconds of a test"
)]
fn now_ms() -> u64 {
    (performance().now() + WORKER_AGE_MS) as u64
}

fn sample(at_ms: u64, rpm: i16) -> Sample {
    Sample {
        at: Instant::from_millis(at_ms),
        reply: Reply {
            id: ID,
            mode: Mode::Velocity,
            current: Some(Current::from_raw(0)),
            speed: Some(Rpm::new(rpm)),
            detail: Detail::Drive {
                position: Position::from_raw(0),
            },
            faults: Faults::NONE,
        },
    }
}

fn report(bench: &Bench, samples: Vec<Sample>) {
    report_activity(bench, Activity::Idle, samples);
}

fn report_activity(bench: &Bench, activity: Activity, samples: Vec<Sample>) {
    bench.post(&ToPage::Update(Update {
        now: Instant::from_millis(now_ms()),
        connection: Connection::Connected(Adapter::VIRTUAL),
        halted: false,
        motors: vec![motor(Mode::Velocity, activity)],
        job: None,
        raw: None,
        line: None,
        samples,
        notices: vec![],
    }));
}

/// So long at this speed, up to now; at most as long as the worker is old.
fn steady(long_ms: u64, rpm: i16) -> Vec<Sample> {
    let now_ms = now_ms();
    let from_ms = now_ms.saturating_sub(long_ms);
    let steps = (from_ms..=now_ms).step_by(20);
    steps.map(|at_ms| sample(at_ms, rpm)).collect()
}

/// The canvas with the lines of this page's graph.
fn canvas(bench: &Bench) -> HtmlCanvasElement {
    let panel = bench.find("region", "Speed and current");
    let canvas = panel.query_selector(".graph-lines").unwrap().unwrap();
    canvas.unchecked_into()
}

fn context(canvas: &HtmlCanvasElement) -> CanvasRenderingContext2d {
    canvas.get_context("2d").unwrap().unwrap().unchecked_into()
}

/// The pixels: red, green, blue, opacity, row by row.
fn pixels(canvas: &HtmlCanvasElement) -> Vec<[u8; 4]> {
    let (width, height) = (canvas.width().max(1), canvas.height().max(1));
    let (width, height) = (width.cast_signed(), height.cast_signed());
    let image = context(canvas).get_image_data(0, 0, width, height).unwrap();
    let bytes = image.data();
    let pixels = bytes.chunks_exact(4);
    pixels.map(|pixel| pixel.try_into().unwrap()).collect()
}

fn is_drawn(canvas: &HtmlCanvasElement) -> bool {
    pixels(canvas).iter().any(|[.., opacity]| *opacity > 0)
}

/// The top and the height of this pane of so many, in pixels of the canvas.
fn pane(canvas: &HtmlCanvasElement, place: usize, count: usize) -> (usize, usize) {
    let height = (canvas.height() as usize - 30 - 10 * (count - 1)) / count;
    (8 + place * (height + 10), height)
}

/// Wipes the canvas, so that the next drawing is seen.
fn wipe(canvas: &HtmlCanvasElement) {
    context(canvas).clear_rect(0.0, 0.0, 1e5, 1e5);
    assert!(!is_drawn(canvas));
}

/// The rows that hold at least this many pixels of a colour.
fn rows_of(canvas: &HtmlCanvasElement, colour: [u8; 3], least: usize) -> Vec<usize> {
    let near = |[red, green, blue, opacity]: &[u8; 4]| {
        let differences = [
            red.abs_diff(colour[0]),
            green.abs_diff(colour[1]),
            blue.abs_diff(colour[2]),
        ];
        // A line between two rows of pixels covers each in part.
        *opacity > 120 && differences.iter().all(|difference| *difference < 12)
    };
    let pixels = pixels(canvas);
    let rows = pixels.chunks_exact(canvas.width() as usize);
    let count = |row: &[[u8; 4]]| row.iter().filter(|pixel| near(pixel)).count();
    let rows = rows.enumerate().filter(|(_, row)| count(row) >= least);
    rows.map(|(place, _)| place).collect()
}

/// The colour that the style sheet gives to a trace.
fn colour_of(bench: &Bench, property: &str) -> [u8; 3] {
    let graph = graph(bench);
    let style = web_sys::window()
        .unwrap()
        .get_computed_style(&graph)
        .unwrap();
    let text = style.unwrap().get_property_value(property).unwrap();
    let digits = text.trim_start_matches("rgb(").trim_end_matches(')');
    let parts: Vec<u8> = digits
        .split(", ")
        .map(|part| part.parse().unwrap())
        .collect();
    parts.try_into().unwrap()
}

fn graph(bench: &Bench) -> HtmlElement {
    let panel = bench.find("region", "Speed and current");
    let graph = panel.query_selector("[role=img]").unwrap().unwrap();
    graph.unchecked_into()
}

fn name(bench: &Bench) -> String {
    graph(bench).get_attribute("aria-label").unwrap()
}

/// A property that the browser has by itself, as the test wants it; gone again when dropped.
struct PropertyOverride {
    of: JsValue,
    property: &'static str,
}

impl PropertyOverride {
    fn new(of: &JsValue, property: &'static str, value: &JsValue) -> Self {
        let how = Object::new();
        Reflect::set(&how, &"value".into(), value).unwrap();
        Reflect::set(&how, &"configurable".into(), &true.into()).unwrap();
        let object: &Object = of.unchecked_ref();
        Object::define_property(object, &property.into(), &how);
        Self {
            of: of.clone(),
            property,
        }
    }
}

impl Drop for PropertyOverride {
    fn drop(&mut self) {
        let object: &Object = self.of.unchecked_ref();
        Reflect::delete_property(object, &self.property.into()).unwrap();
    }
}
