//! Bookmarks of a recording: set, changed, deleted, and saved into a copy.

use motorlink_messages::sessions::{
    Bookmark, FromSessions, SessionExport, SessionMark, ToReplay, ToSessions,
};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::{
    bench::{Bench, pause, text_of},
    fake_sessions::{FakeSessions, drop_file, info, until_said},
};

use super::{begin, end_button, opened, post, replaying, update};

/// Presses a key in the field for the note.
fn key_in_note(bench: &Bench, key: &str) {
    let init = web_sys::KeyboardEventInit::new();
    init.set_key(key);
    init.set_bubbles(true);
    init.set_cancelable(true);
    let event =
        web_sys::KeyboardEvent::new_with_keyboard_event_init_dict("keydown", &init).unwrap();
    bench
        .find("textbox", "Note")
        .dispatch_event(&event)
        .unwrap();
}

async fn add(bench: &Bench, note: &str) {
    bench.click("Add bookmark");
    let asks = || !bench.find_all("textbox", "Note").is_empty();
    bench.until("the note", asks).await;
    bench.enter_into("textbox", "Note", note);
    bench.click("Keep bookmark");
    until_listed(bench, note).await;
}

async fn until_listed(bench: &Bench, text: &str) {
    let is_listed = || {
        let lists = bench.find_all("list", "Events");
        lists.iter().any(|list| text_of(list).contains(text))
    };
    bench.until(text, is_listed).await;
}

/// The bookmarks of the copy that the page asks for.
async fn saved_copy(sessions: &FakeSessions, bench: &Bench) -> Vec<Bookmark> {
    bench.click("Save copy");
    match sessions.next().await.0 {
        ToSessions::SaveCopy(bookmarks) => bookmarks,
        other => panic!("{other:?}"),
    }
}

fn bookmark(after_us: u64, text: &str) -> Bookmark {
    let text = text.to_owned();
    Bookmark { after_us, text }
}

#[wasm_bindgen_test]
async fn a_bookmark_is_set_at_the_place_that_is_shown_and_a_press_goes_there() {
    let (sessions, bench) = replaying("bookmark-set").await;
    add(&bench, "gravel starts here").await;
    assert!(
        bench.find_all("textbox", "Note").is_empty(),
        "the form is closed"
    );
    post(&sessions, update(9_000, 50, false));
    let arrived = || bench.text("status", "Place").starts_with("0:09.000");
    bench.until("the place", arrived).await;
    add(&bench, "and ends").await;
    let events = bench.text("list", "Events");
    let order = ["0:02.000", "gravel", "0:04.000", "0:09.000", "and ends"];
    let places = order.map(|text| events.find(text).unwrap());
    assert!(places.is_sorted(), "{events}");

    bench.click("0:02.000 Bookmark gravel starts here");
    let after_us = 2_000_000;
    assert_eq!(
        sessions.next().await.0,
        ToSessions::Replay(ToReplay::Seek { after_us })
    );
    post(&sessions, update(2_000, 120, false));
    pause(100).await;
    bench.click("Next event");
    bench.click("Next event");
    let received = sessions.received().await;
    assert!(
        matches!(
            received[..],
            [
                ToSessions::Replay(ToReplay::Seek {
                    after_us: 4_000_000
                }),
                ..
            ]
        ),
        "{received:?}"
    );
}

#[wasm_bindgen_test]
async fn a_note_is_changed_by_keys_and_a_bookmark_is_deleted() {
    let (sessions, bench) = replaying("bookmark-edit").await;
    add(&bench, "first").await;
    bench.click("Edit bookmark at 0:02.000");
    let asks = || !bench.find_all("textbox", "Note").is_empty();
    bench.until("the note", asks).await;
    bench.enter_into("textbox", "Note", "given up");
    let cancel = bench.find_all("button", "Cancel");
    cancel.last().unwrap().click();
    bench.until("the form", || !asks()).await;
    assert!(bench.text("list", "Events").contains("first"));
    bench.click("Edit bookmark at 0:02.000");
    bench.until("the note", asks).await;
    bench.enter_into("textbox", "Note", "second");
    key_in_note(&bench, "Enter");
    until_listed(&bench, "second").await;
    sessions.received().await;
    let copy = saved_copy(&sessions, &bench).await;
    assert_eq!(copy, [bookmark(2_000_000, "second")]);
    sessions.post(&FromSessions::Cancelled);
    until_said(&bench, "Cancelled").await;

    bench.click("Edit bookmark at 0:02.000");
    bench.until("the note", asks).await;
    bench.click("Delete bookmark");
    let is_gone = || !bench.text("list", "Events").contains("second");
    bench.until("the deletion", is_gone).await;
    sessions.received().await;
    assert!(saved_copy(&sessions, &bench).await.is_empty());
}

#[wasm_bindgen_test]
async fn what_is_not_saved_outlives_the_replay_and_is_discarded_at_the_second_press() {
    let (sessions, bench) = replaying("bookmark-kept").await;
    add(&bench, "kept").await;
    end_button(&bench).click();
    let is_live = || bench.find_all("region", "Replay").is_empty();
    bench.until("the live line", is_live).await;
    until_listed(&bench, "kept").await;
    sessions.received().await;

    drop_file("other.mcap");
    until_said(&bench, "The bookmarks are not saved").await;
    assert!(sessions.received().await.is_empty(), "the other file waits");
    begin(&sessions, &bench).await;
    add(&bench, "one more").await;
    bench.click("Close file");
    pause(100).await;
    until_listed(&bench, "one more").await;

    let copy = saved_copy(&sessions, &bench).await;
    assert_eq!(copy.len(), 2);
    let exported = FromSessions::Exported {
        what: SessionExport::Copy,
        problems: vec![],
    };
    sessions.post_file(&exported, "the copy");
    until_said(&bench, "Exported run <b>-bookmarks.mcap").await;
    drop_file("other.mcap");
    let opens = sessions.received().await;
    let is_open = |message: &ToSessions| matches!(message, ToSessions::Open { .. });
    assert!(opens.iter().any(is_open), "{opens:?}");
}

#[wasm_bindgen_test]
async fn bookmarks_of_a_file_are_shown_and_can_be_changed() {
    let (sessions, bench) = opened("bookmark-read").await;
    let mut file = info();
    file.marks.push(SessionMark {
        after_us: 3_000_000,
        error: false,
        text: "from the file".to_owned(),
        is_bookmark: true,
    });
    drop_file("other.mcap");
    sessions.next().await;
    sessions.post(&FromSessions::Opened(Box::new(file)));
    until_listed(&bench, "from the file").await;
    let edit = bench.find("button", "Edit bookmark at 0:03.000");
    assert!(
        edit.has_attribute("disabled"),
        "only a replay shows its place"
    );
    begin(&sessions, &bench).await;
    let copy = saved_copy(&sessions, &bench).await;
    assert_eq!(copy, [bookmark(3_000_000, "from the file")]);
}
