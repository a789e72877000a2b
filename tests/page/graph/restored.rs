//! The graph of a session that was restored.

use motorlink_messages::{ToPage, recorder::FromRecorder};
use wasm_bindgen_test::wasm_bindgen_test;

use super::{bench, canvas, colour_of, performance, rows_of, sample};
use crate::fake_recorder::FakeRecorder;

/// Before the worker was, which has just begun here.
#[wasm_bindgen_test]
async fn restored_samples_are_drawn_at_their_times() {
    let recorder = FakeRecorder::new("graph-restored");
    let bench = bench("graph-restored").await;
    let canvas = canvas(&bench);
    let speed = colour_of(&bench, "--speed");
    let time_origin_ms = performance().time_origin() + performance().now();
    bench.post(&ToPage::Hello { time_origin_ms });
    bench.find("radio", "60 s").click();
    recorder.post(&FromRecorder::Restored);
    recorder.received().await;
    assert!(rows_of(&canvas, speed, 1).is_empty());
    let samples = (0..4_000).step_by(20).map(|at_ms| sample(at_ms, 100));
    recorder.post(&FromRecorder::Past {
        zero_us: -20_000_000,
        samples: samples.collect(),
    });
    bench
        .until("a line", || !rows_of(&canvas, speed, 20).is_empty())
        .await;
    let none = bench.find("region", "Speed and current");
    let none = none.query_selector(".graph-none").unwrap().unwrap();
    bench
        .until("no word of an empty graph", || none.has_attribute("hidden"))
        .await;
}
