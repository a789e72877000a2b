//! The session that the browser keeps, and everything erased.

use motorlink::{Preferences, Theme};
use motorlink_messages::{
    bus::Activity,
    protocol::{Mode, Setpoint},
    recorder::{FromRecorder, NotSaved, RecordingStatus, SavedSession, ToRecorder},
};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::{
    bench::{Bench, motor},
    fake_recorder::FakeRecorder,
};

const SESSION: SavedSession = SavedSession {
    from_ms: 1_795_266_900_000.0,
    to_ms: 1_795_268_100_000.0,
    packets: 40_210,
    recorded: 9_000,
    recorded_ms: 200_000,
};

async fn offered(name: &str) -> (FakeRecorder, Bench) {
    let recorder = FakeRecorder::new(name);
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    recorder.received().await;
    assert!(bench.find_all("button", "Restore session").is_empty());
    recorder.post(&FromRecorder::SavedSessionFound(SESSION));
    bench
        .until("the offer", || {
            !bench.find_all("button", "Restore session").is_empty()
        })
        .await;
    (recorder, bench)
}

async fn until_nothing_is_offered(bench: &Bench) {
    bench
        .until("no offer", || {
            bench.find_all("button", "Restore session").is_empty()
        })
        .await;
}

#[wasm_bindgen_test]
async fn a_kept_session_is_offered_in_words_and_restored_once() {
    let (recorder, bench) = offered("kept-restored").await;
    let words = bench.text("status", "Previous session");
    assert!(words.contains("Session from"), "{words}");
    assert!(words.contains("packets, 3 min recorded"), "{words}");
    bench.click("Restore session");
    bench.click("Restore session");
    let received = recorder.received().await;
    assert_eq!(received, [ToRecorder::Restore]);
    let words = bench.text("status", "Previous session");
    assert!(words.contains("Restoring"), "{words}");
    assert!(bench.commands().await.is_empty(), "nothing is driven");
    recorder.post(&FromRecorder::Restored);
    until_nothing_is_offered(&bench).await;
}

#[wasm_bindgen_test]
async fn a_kept_session_is_forgotten_or_left() {
    let (recorder, bench) = offered("kept-forgotten").await;
    bench.click("Delete session");
    until_nothing_is_offered(&bench).await;
    let received = recorder.received().await;
    assert!(received.contains(&ToRecorder::Forget), "{received:?}");
    recorder.post(&FromRecorder::SavedSessionFound(SESSION));
    bench
        .until("the offer", || {
            !bench.find_all("button", "Restore session").is_empty()
        })
        .await;
    bench.click("Dismiss previous session");
    until_nothing_is_offered(&bench).await;
    assert!(recorder.received().await.is_empty());
}

#[wasm_bindgen_test]
async fn the_offer_covers_no_wheel_that_is_driven() {
    let (_recorder, bench) = offered("kept-driven").await;
    let setpoint = Setpoint::Brake;
    let driven = motor(Mode::Velocity, Activity::Driven { setpoint });
    bench.report(driven, false);
    until_nothing_is_offered(&bench).await;
    bench.report(motor(Mode::Velocity, Activity::Idle), false);
    bench
        .until("the offer again", || {
            !bench.find_all("button", "Restore session").is_empty()
        })
        .await;
}

#[wasm_bindgen_test]
async fn a_browser_without_room_is_a_line_of_the_log() {
    let recorder = FakeRecorder::new("kept-no-room");
    let _bench = Bench::with_motor("kept-no-room", Mode::Velocity).await;
    recorder.received().await;
    recorder.post(&FromRecorder::NotSaved(NotSaved::NoRoom));
    let received = recorder.received().await;
    let is_line = |received: &ToRecorder| matches!(received, ToRecorder::AddMessage { error: true, text, .. } if text.contains("storage is full"));
    assert!(received.iter().any(is_line), "{received:?}");
}

#[wasm_bindgen_test]
async fn everything_is_erased_after_a_question_and_not_while_recording() {
    let recorder = FakeRecorder::new("kept-erased");
    let bench = Bench::with_motor("kept-erased", Mode::Velocity).await;
    let chosen = Preferences {
        theme: Theme::Dark,
        ..Preferences::default()
    };
    chosen.save();
    let status = RecordingStatus {
        recording: true,
        ..RecordingStatus::default()
    };
    recorder.post(&FromRecorder::Recording(status));
    bench.open("Settings").await;
    let button = bench.find("button", "Delete all data");
    bench
        .until("the button to say why", || button.has_attribute("disabled"))
        .await;
    let title = button.get_attribute("title").unwrap();
    assert!(title.contains("Stop the recording"), "{title}");
    recorder.post(&FromRecorder::Recording(RecordingStatus::default()));
    bench
        .until("the button", || !button.has_attribute("disabled"))
        .await;
    bench.click("Delete all data");
    bench
        .until("the question", || {
            !bench.find_all("button", "Delete").is_empty()
        })
        .await;
    recorder.received().await;
    bench.click("Delete");
    let received = recorder.received().await;
    assert!(received.contains(&ToRecorder::Erase), "{received:?}");
    let storage = web_sys::window().unwrap().local_storage().unwrap().unwrap();
    let kept = |name: &str| storage.get_item(name).unwrap();
    assert_eq!(kept("motorlink.theme"), None);
    assert_eq!(kept("motorlink.fleet"), None);
    recorder.post(&FromRecorder::Erased { all: true });
    bench
        .until("words", || {
            bench
                .text("status", "Stored in this browser")
                .contains("Deleted")
        })
        .await;
}
