//! Bookmarks of a recording: set, changed, deleted, and saved into a copy.

use std::{cell::Cell, rc::Rc};

use js_sys::Reflect;
use motorlink_messages::sessions::{
    Bookmark, FromSessions, SessionExport, SessionMark, ToReplay, ToSessions,
};
use wasm_bindgen::{JsCast, prelude::Closure};
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, HtmlInputElement};

use crate::{
    bench::{Bench, document, pause, text_of},
    fake_sessions::{FakeSessions, drop_file, info, until_said},
};

use super::{begin, begun, end_button, of_replay, opened, post, replaying, update};

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

fn asks(bench: &Bench) -> bool {
    !bench.find_all("textbox", "Note").is_empty()
}

/// Presses `Edit` of the bookmark at this time.
async fn edit(bench: &Bench, time: &str, note: &str) {
    bench.click(&format!("Edit bookmark at {time}"));
    let is_open = || note_of(bench).as_deref() == Some(note);
    bench.until(note, is_open).await;
}

/// The text of the field for the note.
fn note_of(bench: &Bench) -> Option<String> {
    let field = bench.find_all("textbox", "Note").into_iter().next()?;
    Some(field.unchecked_into::<HtmlInputElement>().value())
}

async fn add(bench: &Bench, note: &str) {
    bench.click("Add bookmark");
    bench.until("the note", || asks(bench)).await;
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
    assert_eq!(sessions.next().await.0, ToSessions::Replay(ToReplay::Begin));
    begun(&sessions, &bench).await;
    let copy = saved_copy(&sessions, &bench).await;
    assert_eq!(copy, [bookmark(3_000_000, "from the file")]);
}

#[wasm_bindgen_test]
async fn a_note_stays_with_its_bookmark_when_another_one_is_edited() {
    let (sessions, bench) = replaying("bookmark-two").await;
    add(&bench, "first").await;
    post(&sessions, update(9_000, 50, false));
    let arrived = || bench.text("status", "Place").starts_with("0:09.000");
    bench.until("the place", arrived).await;
    add(&bench, "second").await;
    edit(&bench, "0:02.000", "first").await;
    bench.enter_into("textbox", "Note", "first, changed");
    edit(&bench, "0:09.000", "second").await;
    key_in_note(&bench, "Enter");
    bench.until("the form", || !asks(&bench)).await;
    sessions.received().await;
    let copy = saved_copy(&sessions, &bench).await;
    let expected = [
        bookmark(2_000_000, "first, changed"),
        bookmark(9_000_000, "second"),
    ];
    assert_eq!(copy, expected);
}

#[wasm_bindgen_test]
async fn escape_cancels_only_the_note_and_the_focus_goes_to_add() {
    let (sessions, bench) = replaying("bookmark-escape").await;
    bench.click("Add bookmark");
    bench.until("the note", || asks(&bench)).await;
    let is_focused = |role, name| {
        let focused = document().active_element();
        focused.as_ref() == Some(bench.find(role, name).as_ref())
    };
    let in_note = || is_focused("textbox", "Note");
    bench.until("the focus", in_note).await;
    bench.enter_into("textbox", "Note", "given up");
    sessions.received().await;
    key_in_note(&bench, "Escape");
    bench.until("the form", || !asks(&bench)).await;
    assert!(is_focused("button", "Add bookmark"));
    let sent = of_replay(sessions.received().await);
    assert!(sent.is_empty(), "the replay goes on: {sent:?}");
    // The panel is still open.
    assert!(!bench.text("list", "Events").contains("given up"));
}

/// How many pages ask before the document closes: those of other tests may be among them.
fn pages_that_ask() -> u32 {
    let event = Event::new("beforeunload").unwrap();
    let times = Rc::new(Cell::new(0));
    let count = Closure::<dyn Fn()>::new({
        let times = Rc::clone(&times);
        move || times.set(times.get() + 1)
    });
    Reflect::set(&event, &"preventDefault".into(), count.as_ref()).unwrap();
    let window = web_sys::window().unwrap();
    window.dispatch_event(&event).unwrap();
    times.get()
}

#[wasm_bindgen_test]
async fn a_written_note_is_kept_at_the_end_of_the_replay_and_the_page_asks_before_it_closes() {
    let (sessions, bench) = replaying("bookmark-written").await;
    let others = pages_that_ask();
    let asks_to_leave = || pages_that_ask() > others;
    bench.click("Add bookmark");
    bench.until("the note", || asks(&bench)).await;
    bench.enter_into("textbox", "Note", "half a sentence");
    assert!(asks_to_leave());
    end_button(&bench).click();
    until_listed(&bench, "half a sentence").await;
    assert!(asks_to_leave());
    let place = bench.find("button", "0:02.000 Bookmark half a sentence");
    assert!(place.has_attribute("disabled"));
    let reason = place.get_attribute("title").unwrap();
    assert_eq!(reason, "Press Replay first.");
    sessions.received().await;
    let copy = saved_copy(&sessions, &bench).await;
    assert_eq!(copy, [bookmark(2_000_000, "half a sentence")]);
    let exported = FromSessions::Exported {
        what: SessionExport::Copy,
        problems: vec![],
    };
    sessions.post_file(&exported, "the copy");
    until_said(&bench, "Exported").await;
    assert!(!asks_to_leave());
}

#[wasm_bindgen_test]
async fn a_wrong_file_leaves_the_replay_and_a_failed_worker_the_bookmarks() {
    let (sessions, bench) = replaying("bookmark-worker").await;
    drop_file("paper.pdf");
    sessions.next().await;
    sessions.post(&FromSessions::NotOpened(None));
    bench
        .until("the text", || {
            !bench.text("status", "Session file").contains("Opening")
        })
        .await;
    assert!(!bench.find_all("region", "Replay").is_empty());
    add(&bench, "kept").await;
    sessions.post(&FromSessions::Died);
    until_said(&bench, "Open the file again to keep its bookmarks.").await;
    sessions.received().await;
    drop_file(&info().name);
    let opens = sessions.received().await;
    let is_open = |message: &ToSessions| matches!(message, ToSessions::Open { .. });
    assert!(opens.iter().any(is_open), "{opens:?}");
    sessions.post(&FromSessions::Opened(Box::new(info())));
    until_listed(&bench, "kept").await;
    bench.click("Close file");
    until_said(&bench, "The bookmarks are not saved").await;
}
