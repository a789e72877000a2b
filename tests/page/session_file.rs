//! The panel `Session file`, with a session worker that does what the test says.

use std::time::Duration;

use js_sys::{Function, Promise};
use motorlink_messages::{
    encode,
    protocol::Mode,
    sessions::{
        FromSessions, NotASession, NotSaved, Progress, RunsKept, RunsSaved, SaveRange,
        SessionExport, ToSessions,
    },
};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, HtmlSelectElement};

use crate::{
    bench::{Bench, LOOKS_MAX, document, pause},
    fake_sessions::{FakeSessions, drop_file, info, run, until_said},
};

/// What the promise of a script gives.
async fn result(script: &str) -> JsValue {
    let promise = Function::new_no_args(script).call0(&JsValue::UNDEFINED);
    let promise: Promise = promise.unwrap().unchecked_into();
    JsFuture::from(promise).await.unwrap()
}

/// The open panel.
async fn panel(name: &str) -> (FakeSessions, Bench) {
    run("window.showSaveFilePicker = undefined");
    let sessions = FakeSessions::new(name);
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    bench.open("Session file").await;
    let is_loaded = || !bench.find_all("button", "Save session").is_empty();
    bench.until("the panel", is_loaded).await;
    (sessions, bench)
}

const fn runs_saved(saved: u32, is_incomplete: bool) -> RunsSaved {
    RunsSaved {
        saved,
        is_incomplete,
    }
}

fn saved(bytes: u64, runs: RunsSaved) -> FromSessions {
    FromSessions::Saved {
        bytes,
        records: 3_000,
        runs,
    }
}

#[wasm_bindgen_test]
async fn a_session_is_saved_with_progress_and_can_be_cancelled() {
    let (sessions, bench) = panel("session-saved").await;
    bench.click("Save session");
    let (message, objects) = sessions.next().await;
    let ToSessions::Save { setup, .. } = message else {
        panic!("{message:?}")
    };
    assert!(setup.contains("motorlink"), "{setup}");
    assert_eq!(objects, 1, "the channel to the recorder, and no file");
    sessions.post(&FromSessions::Saving(Progress { done: 1, of: 4 }));
    let progress = || {
        let bars = bench.find_all("progressbar", "Saving");
        bars.iter()
            .any(|bar| bar.get_attribute("value").as_deref() == Some("250"))
    };
    bench.until("the progress", progress).await;
    bench.click("Cancel saving");
    assert_eq!(sessions.next().await.0, ToSessions::CancelSave);
    sessions.post(&FromSessions::NotSaved(NotSaved::Cancelled));
    until_said(&bench, "Saving cancelled").await;
    bench.click("Save session");
    sessions.next().await;
    sessions.post(&saved(12_345_678, RunsSaved::default()));
    until_said(&bench, "12.4 MB").await;
    bench.click("Save session");
    sessions.next().await;
    sessions.post(&FromSessions::NotSaved(NotSaved::NoRecorder));
    until_said(&bench, "Reload the page").await;
    assert!(bench.commands().await.is_empty(), "nothing is driven");
}

#[wasm_bindgen_test]
async fn the_last_ten_minutes_are_saved_if_chosen_and_runs_are_said() {
    let (sessions, bench) = panel("session-span").await;
    let mut ranges = Vec::new();
    let choose = |choice: &str| {
        let what: HtmlSelectElement = bench.find("combobox", "What to save").unchecked_into();
        what.set_value(choice);
        what.dispatch_event(&Event::new("change").unwrap()).unwrap();
    };
    for (choice, runs, said) in [
        ("line", RunsSaved::default(), " records"),
        (
            "ten-minutes",
            runs_saved(2, false),
            "Runs of experiments: 2",
        ),
        ("line-before", runs_saved(1, true), "are missing"),
    ] {
        choose(choice);
        bench.click("Save session");
        let (ToSessions::Save { range, .. }, _) = sessions.next().await else {
            panic!("it saves")
        };
        ranges.push(range);
        sessions.post(&saved(1_000, runs));
        until_said(&bench, said).await;
    }
    assert_eq!(
        ranges,
        [
            SaveRange::Line,
            SaveRange::Last(Duration::from_secs(600)),
            SaveRange::LineBefore
        ]
    );
    // This page has recorded nothing.
    choose("recording");
    let save = || bench.find("button", "Save session");
    bench
        .until("the reason", || {
            save().title().starts_with("Nothing is recorded")
        })
        .await;
    assert!(save().has_attribute("disabled"));
}

#[wasm_bindgen_test]
async fn the_runs_of_a_file_are_kept_if_asked_for() {
    let (sessions, bench) = panel("session-runs").await;
    drop_file("run.mcap");
    sessions.next().await;
    sessions.post(&FromSessions::Opened(Box::new(info())));
    until_said(&bench, "Opened").await;
    assert_eq!(
        bench.text("list", "Runs of experiments"),
        "Step <i>response</i>"
    );
    bench.click("Keep these runs");
    assert_eq!(sessions.next().await.0, ToSessions::KeepRuns);
    let reads = || !bench.find_all("progressbar", "Reading").is_empty();
    assert!(reads());
    let kept = RunsKept {
        added: 1,
        known: 3,
        unreadable: 2,
        no_room: 4,
        not_stored: 5,
    };
    sessions.post(&FromSessions::RunsKept(Some(kept)));
    until_said(&bench, "tab Runs of Experiments: 1.").await;
    until_said(
        &bench,
        "cannot be read (damaged, or from a later version): 2.",
    )
    .await;
    for said in [
        "already in the list: 3.",
        "the list is full: 4.",
        "could not store: 5.",
    ] {
        until_said(&bench, said).await;
    }
    assert!(!reads(), "the progress ends");
    let shown = bench.text("region", "Session file");
    assert!(shown.contains("More runs in the file: 4"), "{shown}");
    bench.click("Keep these runs");
    sessions.next().await;
    sessions.post(&FromSessions::RunsKept(None));
    until_said(&bench, "stores no runs now").await;
    assert!(bench.commands().await.is_empty(), "nothing is driven");
}

#[wasm_bindgen_test]
async fn a_chosen_file_is_handed_to_the_worker() {
    let (sessions, bench) = panel("session-chosen").await;
    run("window.showSaveFilePicker = async () => {
        const folder = await navigator.storage.getDirectory();
        return folder.getFileHandle('my wheel.mcap', { create: true });
    }");
    bench.click("Save session");
    let (_, objects) = sessions.next().await;
    assert_eq!(objects, 2, "the channel and the handle of the file");
    sessions.post(&saved(12_345_678, RunsSaved::default()));
    until_said(&bench, "Saved my wheel.mcap").await;
    let is_there = async || {
        let looked = result(
            "return navigator.storage.getDirectory()
                .then((folder) => folder.getFileHandle('my wheel.mcap'))
                .then(() => true, () => false)",
        );
        looked.await == true
    };
    assert!(is_there().await, "a saved file stays");
    bench.click("Save session");
    sessions.next().await;
    sessions.post(&FromSessions::NotSaved(NotSaved::NoRoom));
    until_said(&bench, "the disk is full").await;
    // The dialog has emptied it.
    for _ in 0..LOOKS_MAX {
        if !is_there().await {
            break;
        }
        pause(20).await;
    }
    assert!(!is_there().await, "an empty file is left");
    run("window.showSaveFilePicker = async () => { throw new DOMException('', 'AbortError'); }");
    bench.click("Save session");
    until_said(&bench, "Saving cancelled").await;
    assert!(sessions.received().await.is_empty());
}

#[wasm_bindgen_test]
async fn nothing_to_save_is_said_before_a_file_is_chosen() {
    let (sessions, bench) = panel("session-nothing").await;
    run("window.showSaveFilePicker = () => { throw new Error('it would empty a file'); }");
    let answer = encode(&Some(NotSaved::Nothing)).unwrap();
    let recorder = format!(
        "return new Promise((done) => {{
            const recorder = new BroadcastChannel('session-nothing-recorder');
            recorder.onmessage = done;
            recorder.postMessage({{ kept: {answer:?} }});
        }})"
    );
    result(&recorder).await;
    bench.click("Save session");
    until_said(&bench, "Nothing to save yet").await;
    assert!(sessions.received().await.is_empty());
}

#[wasm_bindgen_test]
async fn a_dropped_file_is_opened_and_shown_with_what_is_missing() {
    let sessions = FakeSessions::new("session-dropped");
    let bench = Bench::with_motor("session-dropped", Mode::Velocity).await;
    drop_file("run.mcap");
    let (message, objects) = sessions.next().await;
    let name = "run.mcap".to_owned();
    assert_eq!((message, objects), (ToSessions::Open { name }, 1));
    sessions.post(&FromSessions::Opened(Box::new(info())));
    until_said(&bench, "Opened").await;
    let shown = bench.text("region", "Session file");
    for text in [
        "run <b>.mcap",
        "1:05.250",
        "−100 to +200",
        "Standstill not confirmed",
        "More events in the file: 3",
    ] {
        assert!(shown.contains(text), "no {text:?} in {shown}");
    }
    let missing = bench.text("list", "Missing in the file");
    assert!(
        missing.contains("The end of the file is missing"),
        "{missing}"
    );
    assert!(missing.contains("(2 times)"), "{missing}");
    let picture = document().query_selector("svg[aria-label^='Motor 0x01']");
    assert!(picture.unwrap().is_some());
    let pictures = document().query_selector_all(".session-motor").unwrap();
    assert_eq!(pictures.length(), 1, "motors that replied");
    let lines = document().query_selector(".session-mark.bad").unwrap();
    let lines = lines.unwrap().get_attribute("d").unwrap();
    assert_eq!(lines, "M30 0V60M61 0V60");

    bench.click("Report");
    let report = ToSessions::Export(SessionExport::Report);
    assert_eq!(sessions.next().await.0, report);
    sessions.post(&FromSessions::NotOpened(None));
    until_said(&bench, "cannot be read").await;
    bench.click("Report");
    assert_eq!(sessions.next().await.0, report);
    sessions.post(&FromSessions::Reading(Progress { done: 1, of: 2 }));
    bench.click("Cancel");
    assert_eq!(sessions.next().await.0, ToSessions::CancelReading);
    sessions.post(&FromSessions::Cancelled);
    until_said(&bench, "Cancelled").await;
    bench.click("Close file");
    let is_closed = || bench.find_all("button", "Close file").is_empty();
    bench.until("the file to be closed", is_closed).await;
    assert!(bench.commands().await.is_empty(), "nothing is driven");
}

/// What the system does when a file is opened with the installed app.
#[wasm_bindgen_test]
async fn a_file_that_the_system_opens_with_the_app_is_opened() {
    run(
        "Object.defineProperty(window, 'launchQueue', { configurable: true, value: {
        setConsumer(consumer) { window.launch = consumer; },
    } })",
    );
    let sessions = FakeSessions::new("session-launched");
    let bench = Bench::with_motor("session-launched", Mode::Velocity).await;
    // A launch without a file, by the icon of the app.
    run("window.launch({ files: [] });");
    bench.received().await;
    assert!(bench.find_all("region", "Session file").is_empty());
    run("window.launch({ files: [{ getFile: async () => new File(['x'], 'launched.mcap') }] });");
    let (message, objects) = sessions.next().await;
    let name = "launched.mcap".to_owned();
    assert_eq!((message, objects), (ToSessions::Open { name }, 1));
    bench.find("region", "Session file");
    run("delete window.launchQueue; delete window.launch;");
    assert!(bench.commands().await.is_empty(), "nothing is driven");
}

#[wasm_bindgen_test]
async fn a_file_that_is_no_session_is_an_error_where_it_was_given() {
    let (sessions, bench) = panel("session-zip").await;
    drop_file("run.zip");
    sessions.next().await;
    sessions.post(&FromSessions::NotOpened(Some(NotASession::Zip)));
    until_said(&bench, "Unpack it").await;
    sessions.post(&FromSessions::Died);
    until_said(&bench, "has stopped. Try again.").await;
    bench.click("Save session");
    // Another worker starts.
    assert!(matches!(sessions.next().await.0, ToSessions::Save { .. }));
}
