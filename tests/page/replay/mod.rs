//! A recording in place of the live line: what the page shows, and that nothing is sent.

use motorlink_messages::{
    Adapter, Connection, Notice, ToPage, ToWorker, Update,
    bus::{Activity, Command, MotorStatus, Sample, StopOutcome, StopReason, StopReport, Turns},
    protocol::{Instant, Mode, MotorId, Reply, Rpm, Setpoint, SpeedTarget},
    recorder::{Kind, LogPage, Row, ToRecorder},
    sessions::{FromReplay, FromSessions, Place, PlaySpeed, ToReplay, ToSessions},
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, EventInit, HtmlInputElement};

mod bookmarks;
mod gate;

use crate::{
    bench::{Bench, document, motor, now, pause, performance, press, text_of},
    fake_recorder::FakeRecorder,
    fake_sessions::{FakeSessions, drop_file, info},
    log_bench::Style,
};

/// The clock of the replay begins with the session of the recording, long before this page.
pub const FIRST: Instant = Instant::from_micros(7_000_000);

pub const BEGUN: FromReplay = FromReplay::Begun {
    first: FIRST,
    zero_unix_us: 1_795_266_893_000_000,
    duration_us: 65_250_000,
};

/// A page that is not connected, with an open file whose replay is about to begin.
async fn opened(name: &str) -> (FakeSessions, Bench) {
    let sessions = FakeSessions::new(name);
    let bench = Bench::new(name).await;
    let time_origin_ms = performance().time_origin();
    bench.post(&ToPage::Hello { time_origin_ms });
    bench.received().await;
    drop_file("run.mcap");
    sessions.next().await;
    sessions.post(&FromSessions::Opened(Box::new(info())));
    let is_open = || !bench.find_all("button", "Replay").is_empty();
    bench.until("the file", is_open).await;
    assert_eq!(sessions.next().await.0, ToSessions::Replay(ToReplay::Begin));
    (sessions, bench)
}

/// The port is closed, and this has happened.
pub fn closed_port(notices: Vec<Notice>) -> ToPage {
    ToPage::Update(Update {
        now: now(),
        connection: Connection::Disconnected,
        halted: false,
        motors: vec![],
        job: None,
        raw: None,
        line: None,
        samples: vec![],
        notices,
    })
}

pub fn post(sessions: &FakeSessions, message: FromReplay) {
    sessions.post(&FromSessions::Replay(message));
}

fn status(rpm: i16, at: Instant, activity: Activity) -> MotorStatus {
    let status = motor(Mode::Velocity, activity);
    let speed = Some(Rpm::new(rpm));
    let last = status.last.map(|Sample { reply, .. }| Sample {
        at,
        reply: Reply { speed, ..reply },
    });
    MotorStatus {
        last,
        speed: speed.map(|speed| (at, speed)),
        current: status.current.map(|(_, current)| (at, current)),
        ..status
    }
}

/// The motor is driven, and reports this speed at this place.
pub fn update(after_ms: u64, rpm: i16, plays: bool) -> FromReplay {
    let at = Instant::from_micros(FIRST.as_micros() + after_ms * 1_000);
    let setpoint = Setpoint::velocity(SpeedTarget::clamped(rpm.into()));
    let motor = status(rpm, at, Activity::Driven { setpoint });
    FromReplay::Update {
        place: Place {
            after_us: after_ms * 1_000,
            plays,
        },
        update: Box::new(Update {
            now: at,
            connection: Connection::Connected(Adapter::Recording),
            halted: false,
            samples: motor.last.into_iter().collect(),
            motors: vec![motor],
            job: None,
            raw: None,
            line: None,
            notices: vec![],
        }),
    }
}

/// The same, paused at two seconds of the recording.
async fn replaying(name: &str) -> (FakeSessions, Bench) {
    let (sessions, bench) = opened(name).await;
    begun(&sessions, &bench).await;
    (sessions, bench)
}

/// By the keyboard: the focus goes on to the bar.
async fn begin(sessions: &FakeSessions, bench: &Bench) {
    bench.find("button", "Replay").focus().unwrap();
    bench.click("Replay");
    assert_eq!(sessions.next().await.0, ToSessions::Replay(ToReplay::Begin));
    begun(sessions, bench).await;
    let focused = || document().active_element().and_then(|at| at.text_content());
    let is_on_play = || focused().as_deref() == Some("Play");
    bench.until("the focus on Play", is_on_play).await;
}

async fn begun(sessions: &FakeSessions, bench: &Bench) {
    post(sessions, BEGUN);
    post(sessions, update(2_000, 120, false));
    let is_shown = || bench.text("status", "Speed").contains("+120");
    bench.until("the recording", is_shown).await;
    sessions.received().await;
    bench.received().await;
}

fn connection(bench: &Bench) -> String {
    bench.text("status", "Connection")
}

async fn until_live(bench: &Bench) {
    let is_live = || bench.find_all("region", "Replay").is_empty();
    bench.until("the live line", is_live).await;
    assert!(!connection(bench).contains("Replay"));
    let title = || !document().title().starts_with("Replay");
    bench.until("the title", title).await;
}

fn of_replay(messages: Vec<ToSessions>) -> Vec<ToReplay> {
    let replay = messages.into_iter().filter_map(|message| match message {
        ToSessions::Replay(message) => Some(message),
        _ => None,
    });
    replay.collect()
}

#[wasm_bindgen_test]
async fn a_recording_is_shown_on_the_instruments_and_says_that_it_is_one() {
    let (sessions, bench) = replaying("replay-shown").await;
    assert!(connection(&bench).contains("Replay"));
    let root = document().document_element().unwrap();
    let style = root.get_attribute("style").unwrap();
    assert!(style.contains("\"run <b>.mcap\""), "{style}");
    let titled = || document().title() == "Replay: run <b>.mcap - MotorLink";
    bench.until("the title", titled).await;
    let bar = bench.text("region", "Replay");
    assert!(bar.contains("Replay run <b>.mcap"), "{bar}");
    assert_eq!(bench.text("status", "Place"), "0:02.000 / 1:05.250");
    let chip = bench.text("region", "Wheel");
    assert!(chip.contains("Target +120"), "{chip}");

    // While it is paused nothing grows old.
    pause(800).await;
    assert!(bench.text("status", "Speed").contains("+120"));
    let speed = bench.find("status", "Speed");
    let card = speed.closest(".read-out").unwrap().unwrap();
    assert!(
        !card.class_name().contains("stale"),
        "{}",
        card.class_name()
    );

    post(&sessions, FromReplay::Jumped);
    post(&sessions, update(60_000, -80, false));
    let jumped = || bench.text("status", "Speed").contains("\u{2212}80");
    bench.until("the other place", jumped).await;
    assert_eq!(bench.text("status", "Place"), "1:00.000 / 1:05.250");
}

/// Live, a dialog asks for Release. In a recording nothing can be released, and keys stay those of a replay.
#[wasm_bindgen_test]
async fn a_recorded_stop_of_all_motors_is_said_in_the_bar_and_opens_no_dialog() {
    let (sessions, bench) = replaying("replay-halted").await;
    let FromReplay::Update { place, mut update } = update(3_000, 0, false) else {
        panic!("an update")
    };
    update.halted = true;
    update.motors[0].turns = Some(Turns::new(-4.5));
    post(&sessions, FromReplay::Update { place, update });
    let is_said = || {
        bench
            .text("region", "Replay")
            .contains("STOP is active until Release")
    };
    bench.until("the stop", is_said).await;
    assert!(bench.find_all("alertdialog", "Stopped").is_empty());
    let turns = || bench.text("region", "Wheel").contains("\u{2212}4.5 turns");
    bench.until("the turns", turns).await;
}

#[wasm_bindgen_test]
async fn rows_of_the_recording_take_the_place_of_the_log_and_the_log_is_back_after_it() {
    let _style = Style::new();
    let recorder = FakeRecorder::new("replay-log");
    let (sessions, bench) = opened("replay-log").await;
    recorder.log(3);
    let entries = |text: &'static str| {
        let bench = &bench;
        move || bench.text("status", "Entries") == text
    };
    bench.until("the live log", entries("3 entries")).await;
    recorder.received().await;
    post(&sessions, BEGUN);
    post(&sessions, update(2_000, 120, false));
    let is_on = || !bench.find_all("region", "Replay").is_empty();
    bench.until("the replay", is_on).await;
    let asked = of_replay(sessions.received().await);
    let asks = |what: fn(&ToReplay) -> bool| asked.iter().any(what);
    assert!(asks(|it| matches!(it, ToReplay::ShowRows(_))), "{asked:?}");
    let in_language = |it: &ToReplay| matches!(it, ToReplay::SetLanguage { .. });
    assert!(asks(in_language), "{asked:?}");

    let rows = LogPage {
        end: 7,
        kept: 7,
        filtered_per_mille: 1000,
        generation: 10,
        rows: vec![Row {
            number: 6,
            kind: Kind::Rx,
            time: "09:00:02.000".to_owned(),
            id: "0x01".to_owned(),
            hex: String::new(),
            meaning: "recorded".to_owned(),
            collapsed_before: 0,
            opened: 0,
        }],
        ..LogPage::default()
    };
    let frame = rows.rows.last().cloned().map(Box::new);
    let rows = Box::new(rows);
    post(&sessions, FromReplay::Log { rows, frame });
    bench.until("its rows", entries("7 entries")).await;
    // What happens on the page meanwhile reaches neither log.
    recorder.log(1);
    press("f");
    pause(200).await;
    assert_eq!(bench.text("status", "Entries"), "7 entries");
    assert!(recorder.received().await.is_empty());
    bench.open("Recording").await;
    for name in ["Clear", "Export CSV", "Export telemetry CSV", "Plot CSV"] {
        let button = bench.find("button", name);
        assert!(button.has_attribute("disabled"), "{name}");
    }

    end_button(&bench).click();
    bench
        .until("the live log again", entries("4 entries"))
        .await;
    until_live(&bench).await;
    let sent = recorder.received().await;
    let has_language = |message: &ToRecorder| matches!(message, ToRecorder::SetLanguage { .. });
    assert!(sent.iter().all(has_language), "{sent:?}");
    assert!(bench.text("status", "Speed").contains('–'));
}

/// The one of the bar: the panel has another.
pub fn end_button(bench: &Bench) -> web_sys::HtmlElement {
    let buttons = bench.find_all("button", "End replay");
    assert_eq!(buttons.len(), 2);
    let in_bar = |button: &&web_sys::HtmlElement| button.closest(".replay").unwrap().is_some();
    buttons.iter().find(in_bar).unwrap().clone()
}

#[wasm_bindgen_test]
async fn the_bar_plays_steps_and_goes_to_places() {
    let (sessions, bench) = replaying("replay-bar").await;
    let next = async || match sessions.next().await.0 {
        ToSessions::Replay(message) => message,
        other => panic!("{other:?}"),
    };
    bench.click("Play");
    assert_eq!(next().await, ToReplay::Play(PlaySpeed::REAL_TIME));
    post(&sessions, update(2_033, 121, true));
    let plays = || !bench.find_all("button", "Pause replay").is_empty();
    bench.until("playing", plays).await;
    let speed: web_sys::HtmlSelectElement = bench
        .find("combobox", "Speed of the replay")
        .unchecked_into();
    speed.set_value("10000");
    let bubbles = EventInit::new();
    bubbles.set_bubbles(true);
    let change = Event::new_with_event_init_dict("change", &bubbles).unwrap();
    speed.dispatch_event(&change).unwrap();
    let ten_times = PlaySpeed::from_per_mille(10_000);
    assert_eq!(next().await, ToReplay::Play(ten_times));
    bench.click("Pause replay");
    assert_eq!(next().await, ToReplay::Pause);
    post(&sessions, update(2_500, 121, false));
    for (name, forward) in [("Next frame", true), ("Previous frame", false)] {
        bench.click(name);
        assert_eq!(next().await, ToReplay::Step { forward });
    }
    bench.click("Previous event");
    let after_us = 2_000_000;
    assert_eq!(next().await, ToReplay::Seek { after_us });

    // A slider that is dragged asks for one place at a time, and for the last one in the end.
    let slider = slider(&bench);
    for after_us in ["10000000", "11000000", "12000000"] {
        slider.set_value(after_us);
        slider
            .dispatch_event(&Event::new("input").unwrap())
            .unwrap();
    }
    assert!(of_replay(sessions.received().await).is_empty());
    assert_eq!(slider.value(), "12000000", "it stays where it was dragged");
    post(&sessions, update(2_000, 120, false));
    let after_us = 12_000_000;
    assert_eq!(next().await, ToReplay::Seek { after_us });
    post(&sessions, update(12_000, 90, false));
    let arrived = || bench.text("status", "Place").starts_with("0:12.000");
    bench.until("the place", arrived).await;
    assert!(of_replay(sessions.received().await).is_empty());

    bench.click("0:02.000 Standstill not confirmed");
    let after_us = 2_000_000;
    assert_eq!(next().await, ToReplay::Seek { after_us });
    post(&sessions, update(65_250, 0, false));
    pause(100).await;
    // At the end it plays from the start.
    bench.click("Play");
    assert_eq!(next().await, ToReplay::Seek { after_us: 0 });
    post(&sessions, update(0, 0, false));
    assert_eq!(next().await, ToReplay::Play(ten_times));
}
fn slider(bench: &Bench) -> HtmlInputElement {
    bench
        .find("slider", "Place in the recording")
        .unchecked_into()
}

#[wasm_bindgen_test]
async fn a_recording_has_its_own_names_and_sides_and_those_of_the_page_come_back() {
    let storage = web_sys::window().unwrap().local_storage();
    let storage = storage.unwrap().unwrap();
    let mine = "1\tno\tnone\tMine\t\n";
    storage.set_item("motorlink.fleet", mine).unwrap();
    let (_sessions, bench) = replaying("replay-names").await;
    let shown = |name: &'static str| {
        let bench = &bench;
        move || text_of(&bench.find("list", "Motors")).contains(name)
    };
    bench.until("its name", shown("Front left")).await;
    assert!(!shown("Mine")());
    // A name that is typed meanwhile is one of the recording.
    bench.click("Name and side of motor 0x01");
    let field = || bench.find_all("textbox", "Name").into_iter().next();
    bench.until("the field", || field().is_some()).await;
    let field: HtmlInputElement = field().unwrap().unchecked_into();
    field.set_value("Typed");
    press("Enter");
    bench.until("the typed name", shown("Typed")).await;
    end_button(&bench).click();
    until_live(&bench).await;
    let kept = storage.get_item("motorlink.fleet").unwrap();
    assert_eq!(kept.as_deref(), Some(mine));
    storage.remove_item("motorlink.fleet").unwrap();
}
