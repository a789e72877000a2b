//! What the page tells the recorder, and what it does with what it hears.

use std::{cell::RefCell, rc::Rc};

use js_sys::Array;
use motorlink_i18n::translate;
use motorlink_messages::{
    Adapter, Notice, ToPage,
    bus::{Activity, Command, StopOutcome, StopReason, StopReport},
    protocol::{Mode, MotorId, Setpoint, SpeedTarget},
    recorder::{Export, Filter, FromRecorder, Kind, RecordingStatus, ToRecorder},
};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use wasm_bindgen_futures::JsFuture;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{AddEventListenerOptions, Blob, Element, Event, Response};

use crate::{
    bench::{Bench, document, motor, pause, performance, press},
    fake_recorder::FakeRecorder,
    log_bench::page,
};

/// It is not lost because the page can be used before its workers are there.
#[wasm_bindgen_test]
async fn what_is_said_before_there_is_a_recorder_is_logged_once_there_is() {
    let recorder = FakeRecorder::new("log-early");
    let bench = Bench::after("log-early", || press("1")).await;
    let said = bench.text("region", "Notices");
    assert!(said.contains("not started"), "{said}");
    let time_origin_ms = performance().time_origin();
    bench.post(&ToPage::Hello { time_origin_ms });
    let received = recorder.received().await;
    let place = |is: fn(&ToRecorder) -> bool| received.iter().position(is);
    let epoch = place(|received| matches!(received, ToRecorder::Epoch { .. })).unwrap();
    let line = place(
        |received| matches!(received, ToRecorder::AddMessage { text, .. } if text.contains("not started")),
    );
    assert!(line.unwrap() > epoch, "{received:?}");
}

#[wasm_bindgen_test]
async fn both_workers_get_an_end_of_one_line() {
    let (recorder, _bench, _style) = page("line", 0).await;
    assert!(recorder.is_connected());
}

#[wasm_bindgen_test]
async fn a_filter_is_sent_when_one_has_typed() {
    let (recorder, bench, _style) = page("filter", 10).await;
    bench.enter_into("searchbox", "Filter", "0x");
    bench.enter_into("searchbox", "Filter", "0x05");
    let filter = |text: &str, kind| {
        ToRecorder::Filter(Filter {
            text: text.to_owned(),
            id: None,
            kind,
            collapse: true,
        })
    };
    assert_eq!(recorder.received().await, [filter("0x05", None)]);

    let list: web_sys::HtmlSelectElement = bench.find("combobox", "Log direction").unchecked_into();
    list.set_value("2");
    list.dispatch_event(&Event::new("change").unwrap()).unwrap();
    assert_eq!(recorder.received().await, [filter("0x05", Some(Kind::Rx))]);
}

#[wasm_bindgen_test]
async fn collapsing_is_on_at_first_and_remembered() {
    let recorder = FakeRecorder::new("collapse");
    let bench = Bench::new("collapse").await;
    let collapse = |received: &[ToRecorder]| match received {
        [.., ToRecorder::Filter(filter)] => Some(filter.collapse),
        _ => None,
    };
    assert_eq!(collapse(&recorder.received().await), Some(true));
    bench.find("checkbox", "Collapse status polls").click();
    assert_eq!(collapse(&recorder.received().await), Some(false));
    assert!(!motorlink::Preferences::load().collapse_polls);
    motorlink::Preferences::default().save();
}

/// The messages of the page, and which of them are errors.
fn said(received: Vec<ToRecorder>) -> Vec<(bool, String)> {
    let said = received.into_iter().filter_map(|message| match message {
        ToRecorder::AddMessage { error, text, .. } => Some((error, translate(&text))),
        _ => None,
    });
    said.collect()
}

/// A start in another loop stops the motor first: one update can bring the end of the stop and the drive.
#[wasm_bindgen_test]
async fn a_stop_is_logged_before_the_drive_that_waited_for_it() {
    let recorder = FakeRecorder::new("stop-and-drive");
    let bench = Bench::with_motor("stop-and-drive", Mode::Velocity).await;
    recorder.received().await;
    let setpoint = Setpoint::velocity(SpeedTarget::clamped(50));
    let stopped = StopReport {
        reason: StopReason::OneMotor,
        motors: vec![StopOutcome {
            id: MotorId::FIRST,
            confirmed: true,
            speed: None,
        }],
    };
    bench.report_with(
        Adapter::VIRTUAL,
        motor(Mode::Velocity, Activity::Driven { setpoint }),
        false,
        vec![Notice::StopEnded(stopped)],
    );
    assert_eq!(
        said(recorder.received().await),
        [
            (false, "Stopped, standstill confirmed: 0x01".to_owned()),
            (false, "Motor 0x01 is running: +50 rpm".to_owned())
        ]
    );
}

#[wasm_bindgen_test]
async fn what_happens_on_the_page_is_logged() {
    let recorder = FakeRecorder::new("lines");
    let bench = Bench::with_motor("lines", Mode::Velocity).await;
    let received = recorder.received().await;
    assert!(
        received
            .iter()
            .any(|message| matches!(message, ToRecorder::Epoch { unix_ms } if *unix_ms > 1e12))
    );
    assert_eq!(
        said(received),
        [(false, "Connected to Virtual motor".to_owned())]
    );
    // Refused by the page already.
    bench.report(motor(Mode::Velocity, Activity::Idle), true);
    bench
        .until("the halt", || {
            bench.find("button", "+100").has_attribute("disabled")
        })
        .await;
    press("2");
    let said = said(recorder.received().await);
    let [(false, text)] = said.as_slice() else {
        panic!("{said:?}");
    };
    assert!(text.starts_with("Motor 0x01 not started. "), "{text}");
}

#[wasm_bindgen_test]
async fn a_cleared_log_comes_back_on_request_but_not_by_a_double_click() {
    let (recorder, bench, _style) = page("clear", 1_001).await;
    let entries = || bench.text("status", "Entries");
    bench
        .until("the entries", || entries().contains("001 entries"))
        .await;
    let before = entries();
    bench.click("Clear");
    assert_eq!(recorder.received().await, [ToRecorder::Clear]);
    bench
        .until("an empty log", || entries() == "0 entries")
        .await;
    bench.click("Undo");
    assert_eq!(recorder.received().await, []);
    pause(600).await;
    bench.click("Undo");
    assert_eq!(
        recorder.received().await,
        [ToRecorder::EndClear { undo: true }]
    );
    bench
        .until("the same entries", || entries() == before)
        .await;
    bench.find("button", "Clear");
}

/// The next file that the page saves: its name, and what is in it.
struct Saved(
    Rc<RefCell<Option<(String, String)>>>,
    Closure<dyn FnMut(Event)>,
);

impl Saved {
    fn watch() -> Self {
        let found = Rc::new(RefCell::new(None));
        let on_click = Closure::<dyn FnMut(Event)>::new({
            let found = found.clone();
            move |event: Event| {
                let link: Element = event.target().unwrap().unchecked_into();
                if let Some(name) = link.get_attribute("download") {
                    event.prevent_default();
                    let url = link.get_attribute("href").unwrap();
                    *found.borrow_mut() = Some((name, url));
                }
            }
        });
        let options = AddEventListenerOptions::new();
        options.set_capture(true);
        document()
            .add_event_listener_with_callback_and_add_event_listener_options(
                "click",
                on_click.as_ref().unchecked_ref(),
                &options,
            )
            .unwrap();
        Self(found, on_click)
    }

    async fn file(&self) -> Option<(String, String)> {
        let (name, url) = self.0.borrow_mut().take()?;
        let window = web_sys::window().unwrap();
        let response = JsFuture::from(window.fetch_with_str(&url)).await.unwrap();
        let text = response.unchecked_into::<Response>().text().unwrap();
        Some((
            name,
            JsFuture::from(text).await.unwrap().as_string().unwrap(),
        ))
    }
}

impl Drop for Saved {
    fn drop(&mut self) {
        let callback = self.1.as_ref().unchecked_ref();
        let _ = document().remove_event_listener_with_callback_and_bool("click", callback, true);
    }
}

#[wasm_bindgen_test]
async fn an_export_shows_how_far_it_is_and_saves_a_file() {
    let (recorder, bench, _style) = page("export", 10).await;
    let saved = Saved::watch();
    bench.click("Export CSV");
    assert_eq!(recorder.received().await, [ToRecorder::Export(Export::Log)]);
    bench.find("button", "Cancel export");
    bench.open("Recording").await;
    for other in ["Export telemetry CSV", "Plot CSV"] {
        assert!(bench.find("button", other).has_attribute("disabled"));
    }
    let what = Export::Log;
    recorder.post(&FromRecorder::Exporting {
        what,
        done: 5,
        of: 10,
    });
    let progress = || bench.find("progressbar", "Export").get_attribute("value");
    bench
        .until("half", || progress().as_deref() == Some("500"))
        .await;

    let parts = Array::of1(&JsValue::from_str("time,elapsed_s\r\n"));
    let file = Blob::new_with_str_sequence(&parts).unwrap();
    let name = "motorlink-log.csv".to_owned();
    recorder.post_with_file(
        &FromRecorder::Exported {
            what,
            name,
            rows: 10,
        },
        &file,
    );
    bench
        .until("the button", || {
            bench.find_all("button", "Export CSV").len() == 1
        })
        .await;
    let (name, text) = saved.file().await.unwrap();
    assert_eq!(
        (name.as_str(), text.as_str()),
        ("motorlink-log.csv", "time,elapsed_s\r\n")
    );
    let received = recorder.received().await;
    assert!(
        matches!(&received[..], [ToRecorder::AddMessage { text, .. }] if translate(text).contains("10 rows")),
        "{received:?}"
    );

    bench.click("Export CSV");
    bench
        .until("the way to end it", || {
            bench.find_all("button", "Cancel export").len() == 1
        })
        .await;
    bench.click("Cancel export");
    assert_eq!(
        recorder.received().await,
        [ToRecorder::Export(Export::Log), ToRecorder::CancelExport]
    );
    recorder.post(&FromRecorder::NotExported {
        what,
        cancelled: true,
    });
    bench
        .until("the button", || {
            bench.find_all("button", "Export CSV").len() == 1
        })
        .await;
    assert_eq!(saved.file().await, None);
}

#[wasm_bindgen_test]
async fn the_recording_says_what_it_holds() {
    let (recorder, bench, _style) = page("recording", 0).await;
    bench.open("Recording").await;
    let mut status = RecordingStatus {
        rolling: 6_012,
        ..RecordingStatus::default()
    };
    recorder.post(&FromRecorder::Recording(status));
    let words = || bench.text("status", "Recorded").replace('\u{202F}', " ");
    bench
        .until("the samples", || words() == "Last 10 min: 6 012 samples")
        .await;
    bench.click("Record telemetry");
    assert_eq!(recorder.received().await, [ToRecorder::Record(true)]);
    status.recording = true;
    status.recorded = 6_650;
    status.recorded_ms = 133_000;
    recorder.post(&FromRecorder::Recording(status));
    bench
        .until("the time", || {
            words() == "Recording: 00:02:13, 6 650 samples"
        })
        .await;
    bench.click("Stop recording");
    bench.click("Export telemetry CSV");
    assert_eq!(
        recorder.received().await,
        [
            ToRecorder::Record(false),
            ToRecorder::Export(Export::Telemetry)
        ]
    );
    let what = Export::Telemetry;
    let cancelled = true;
    recorder.post(&FromRecorder::NotExported { what, cancelled });
    bench
        .until("the button", || {
            !bench.find("button", "Plot CSV").has_attribute("disabled")
        })
        .await;
    bench.click("Plot CSV");
    assert!(
        recorder
            .received()
            .await
            .contains(&ToRecorder::Export(Export::Plot))
    );
    bench.find("button", "Cancel export");
}

#[wasm_bindgen_test]
async fn a_dead_recorder_is_told_and_driving_goes_on() {
    let (recorder, bench, _style) = page("dead", 10).await;
    recorder.post(&FromRecorder::Died);
    bench
        .until("the words", || {
            bench.text("region", "Notices").contains("packet log")
        })
        .await;
    assert!(
        bench
            .text("region", "Packet log")
            .contains("Motors keep running")
    );
    bench.open("Recording").await;
    for name in [
        "Clear",
        "Export CSV",
        "Record telemetry",
        "Export telemetry CSV",
        "Plot CSV",
    ] {
        let button = bench.find("button", name);
        assert!(button.has_attribute("disabled"), "{name}");
        assert!(button.title().contains("has stopped"), "{name}");
    }
    bench.click("+100");
    assert!(matches!(
        &bench.commands().await[..],
        [Command::Start { .. }]
    ));
}
