//! The session that the browser keeps, and everything erased.

use motorlink::{Preferences, Theme};
use motorlink_messages::{
    journal::{FromJournal, KeptSession, NotKept, RecordingStatus, ToJournal},
    protocol::Mode,
};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::{bench::Bench, fake_journal::FakeJournal};

const SESSION: KeptSession = KeptSession {
    from_ms: 1_795_266_900_000.0,
    to_ms: 1_795_268_100_000.0,
    packets: 40_210,
    recorded: 9_000,
    recorded_ms: 200_000,
};

async fn offered(name: &str) -> (FakeJournal, Bench) {
    let journal = FakeJournal::new(name);
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    journal.told().await;
    assert!(bench.find_all("button", "Restore session").is_empty());
    journal.say(&FromJournal::Kept(SESSION));
    bench
        .until("the offer", || {
            !bench.find_all("button", "Restore session").is_empty()
        })
        .await;
    (journal, bench)
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
    let (journal, bench) = offered("kept-restored").await;
    let words = bench.text("status", "Kept session");
    assert!(words.contains("is kept in this browser"), "{words}");
    assert!(words.contains("packets, 3 min recorded"), "{words}");
    bench.click("Restore session");
    bench.click("Restore session");
    let told = journal.told().await;
    assert_eq!(told, [ToJournal::Restore]);
    let words = bench.text("status", "Kept session");
    assert!(words.contains("being restored"), "{words}");
    assert!(bench.commands().await.is_empty(), "nothing is driven");
    journal.say(&FromJournal::Restored);
    until_nothing_is_offered(&bench).await;
}

#[wasm_bindgen_test]
async fn a_kept_session_is_forgotten_or_left() {
    let (journal, bench) = offered("kept-forgotten").await;
    bench.click("Forget session");
    until_nothing_is_offered(&bench).await;
    let told = journal.told().await;
    assert!(told.contains(&ToJournal::Forget), "{told:?}");
    journal.say(&FromJournal::Kept(SESSION));
    bench
        .until("the offer", || {
            !bench.find_all("button", "Restore session").is_empty()
        })
        .await;
    bench.click("Dismiss kept session");
    until_nothing_is_offered(&bench).await;
    assert!(journal.told().await.is_empty());
}

#[wasm_bindgen_test]
async fn a_browser_without_room_is_a_line_of_the_log() {
    let journal = FakeJournal::new("kept-no-room");
    let _bench = Bench::with_motor("kept-no-room", Mode::Velocity).await;
    journal.told().await;
    journal.say(&FromJournal::NotKept(NotKept::NoRoom));
    let told = journal.told().await;
    let is_line = |told: &ToJournal| matches!(told, ToJournal::Say { error: true, text, .. } if text.contains("no room"));
    assert!(told.iter().any(is_line), "{told:?}");
}

#[wasm_bindgen_test]
async fn everything_is_erased_after_a_question_and_not_while_recording() {
    let journal = FakeJournal::new("kept-erased");
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
    journal.say(&FromJournal::Recording(status));
    bench.open("Settings").await;
    let button = bench.find("button", "Erase kept data");
    bench
        .until("the button to say why", || button.has_attribute("disabled"))
        .await;
    let title = button.get_attribute("title").unwrap();
    assert!(title.contains("End the recording"), "{title}");
    journal.say(&FromJournal::Recording(RecordingStatus::default()));
    bench
        .until("the button", || !button.has_attribute("disabled"))
        .await;
    bench.click("Erase kept data");
    bench
        .until("the question", || {
            !bench.find_all("button", "Erase").is_empty()
        })
        .await;
    journal.told().await;
    bench.click("Erase");
    let told = journal.told().await;
    assert!(told.contains(&ToJournal::Erase), "{told:?}");
    let storage = web_sys::window().unwrap().local_storage().unwrap().unwrap();
    let kept = |name: &str| storage.get_item(name).unwrap();
    assert_eq!(kept("motorlink.theme"), None);
    assert_eq!(kept("motorlink.fleet"), None);
    journal.say(&FromJournal::Erased { all: true });
    bench
        .until("words", || bench.text("status", "Setup").contains("Erased"))
        .await;
}
