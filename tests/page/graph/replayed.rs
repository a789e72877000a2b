//! The graph of a recording, and the one of the live line after it.

use motorlink_messages::{
    bus::Sample,
    protocol::Instant,
    sessions::{FromReplay, FromSessions, ToReplay, ToSessions},
};
use wasm_bindgen_test::wasm_bindgen_test;

use super::{bench, canvas, colour_of, graph, pane, report, rows_of, sample, steady};
use crate::{
    bench::press,
    fake_sessions::{FakeSessions, drop_file, info},
    replay::{BEGUN, FIRST, closed_port, end_button, post, update},
};

#[wasm_bindgen_test]
async fn a_recording_has_its_own_graph_and_the_live_one_is_back_after_it() {
    let sessions = FakeSessions::new("graph-replayed");
    let bench = bench("graph-replayed").await;
    let canvas = canvas(&bench);
    let speed = colour_of(&bench, "--speed");
    let line = || rows_of(&canvas, speed, 20);
    report(&bench, steady(20_000, 300));
    bench.until("the live line", || !line().is_empty()).await;
    bench.find("checkbox", "Symmetric").click();
    let (top, height) = pane(&canvas, 0, 2);
    let middle = top + height / 2;
    let is_above = || line().iter().all(|row| *row < middle) && !line().is_empty();
    bench.until("it to be above zero", is_above).await;
    bench.post(&closed_port(vec![]));

    drop_file("run.mcap");
    sessions.next().await;
    sessions.post(&FromSessions::Opened(Box::new(info())));
    assert_eq!(sessions.next().await.0, ToSessions::Replay(ToReplay::Begin));
    post(&sessions, BEGUN);
    post(&sessions, update(30_000, -300, false));
    bench.until("the live line to go", || !is_above()).await;
    let past = (10_000..30_000).step_by(20).map(|after_ms| Sample {
        at: Instant::from_micros(FIRST.as_micros() + after_ms * 1_000),
        ..sample(0, -300)
    });
    post(&sessions, FromReplay::Past(past.collect()));
    let is_below = || line().iter().all(|row| *row > middle) && !line().is_empty();
    bench.until("the line of the recording", is_below).await;

    bench.click("Pause");
    graph(&bench).focus().unwrap();
    press("ArrowLeft");
    sessions.received().await;
    press("Enter");
    let sent = sessions.received().await;
    let seeks = |message: &ToSessions| matches!(message, ToSessions::Replay(ToReplay::Seek { .. }));
    assert!(sent.iter().any(seeks), "{sent:?}");

    bench.click("Now");
    end_button(&bench).click();
    bench.until("the live line again", is_above).await;
}
