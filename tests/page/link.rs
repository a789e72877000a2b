//! The panel Link: the line in figures, the doctor, and the virtual motor's wire.

use std::time::Duration;

use js_sys::{Function, Reflect};
use motorlink_messages::{
    Adapter, Connection, LineCondition, ToWorker,
    bus::{Answer, Counters, LineStatus, RoundTripStatus, Sample},
    protocol::{Current, Detail, Faults, Mode, MotorId, Position, Reply, Rpm},
};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, EventInit, HtmlSelectElement};

use crate::{
    bench::{Bench, document, pause, text_of},
    tools::report,
};

async fn open(name: &str) -> Bench {
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    bench.open("Link health").await;
    let there = || !bench.find_all("combobox", "Simulated fault").is_empty();
    bench.until("the panel", there).await;
    bench
}

/// The line as it is when motor 1 was asked so often and answered none.
fn silent(bench: &Bench, requests: u64) {
    report(bench, |update| {
        update.line = Some(LineStatus {
            exchanges_hz: 87,
            waiting_per_mille: 414,
            round_trip: RoundTripStatus {
                median_us: Some(2_340),
                ..RoundTripStatus::default()
            },
            carries_hz: Some(54),
            ..LineStatus::default()
        });
        if requests > 0 {
            update.motors[0].answer = Answer::Missing;
        }
        update.motors[0].counters = Counters {
            requests,
            silences: requests,
            ..Counters::default()
        };
    });
}

#[wasm_bindgen_test]
async fn the_line_is_shown_and_the_doctor_says_what_is_wrong() {
    let bench = open("link-doctor").await;
    let doctor = || bench.text("list", "Link diagnosis");
    bench
        .until("nothing said", || doctor().starts_with("Connect"))
        .await;
    silent(&bench, 0);
    bench
        .until("the figures", || {
            bench.text("status", "Exchanges") == "87/s"
        })
        .await;
    assert_eq!(
        bench.text("status", "Bus load"),
        "0 % drive 0 % queries 0 % other 41 % waiting"
    );
    assert_eq!(bench.text("status", "Round trip"), "2.4 ms median – ms p99");
    let bars = bench.find("img", "Round trip histogram");
    assert_eq!(bars.query_selector_all("text").unwrap().length(), 12);
    assert_eq!(doctor(), "Not enough data for a diagnosis yet.");
    silent(&bench, 30);
    bench
        .until("the table", || {
            bench
                .text("", "Motors on the bus")
                .contains("RepliesLostLateCorruptedNot askedEchoesForeign0x0103000000Others")
        })
        .await;
    bench
        .until("the diagnosis", || doctor().starts_with("No bytes"))
        .await;
    let panel = bench.find("region", "Link health");
    assert!(text_of(&panel).contains("The bus allows only 54 Hz per motor"));
}

#[wasm_bindgen_test]
async fn the_virtual_wire_is_chosen_and_a_real_one_is_not() {
    let bench = open("link-wire").await;
    let wire =
        || -> HtmlSelectElement { bench.find("combobox", "Simulated fault").unchecked_into() };
    assert!(!wire().disabled());
    wire().set_value("3");
    let init = EventInit::new();
    init.set_bubbles(true);
    let change = Event::new_with_event_init_dict("change", &init).unwrap();
    wire().dispatch_event(&change).unwrap();
    let received = bench.received().await;
    assert!(
        received.contains(&ToWorker::VirtualWire(LineCondition::SharedId)),
        "{received:?}"
    );
    assert_eq!(wire().value(), "3");
    report(&bench, |update| {
        update.connection = Connection::Connected(Adapter::Serial(None));
    });
    bench.until("it to be disabled", || wire().disabled()).await;
    assert!(!wire().title().is_empty());
    bench
        .until("it to be forgotten", || wire().value() == "0")
        .await;
}

/// Exchanges on a machine that is so busy, with a wheel that turns. The governor goes by the time of the update,
/// which is ahead.
fn spinning(bench: &Bench, late_hz: u16, ahead: Duration) {
    report(bench, |update| {
        let now = update.now;
        update.now = now + ahead;
        // 100 rpm counter-clockwise: the angle falls by 0.6 degrees a millisecond.
        let turned_deg = now.as_micros() * 6 / 10_000 % 360;
        let position = (359 - turned_deg) * 32_767 / 360;
        update.line = Some(LineStatus {
            exchanges_hz: 100,
            late_hz,
            ..LineStatus::default()
        });
        update.samples = vec![Sample {
            at: now + ahead,
            reply: Reply {
                id: MotorId::FIRST,
                mode: Mode::Velocity,
                current: Some(Current::from_raw(0)),
                speed: Some(Rpm::new(100)),
                detail: Detail::Drive {
                    position: Position::from_raw(u16::try_from(position).unwrap()),
                },
                faults: Faults::default(),
            },
        }];
    });
}

/// How the browser steps through the animation that turns the wheel; `None` where it has none.
fn easing() -> Option<String> {
    let call = |object: &JsValue, name: &str| -> Option<JsValue> {
        let method: Function = Reflect::get(object, &name.into()).ok()?.dyn_into().ok()?;
        method.call0(object).ok()
    };
    let get = |object: &JsValue, name: &str| Reflect::get(object, &name.into()).ok();
    let wheel = document().query_selector(".bench .twin-turning").ok()??;
    let animation = get(&call(&wheel, "getAnimations")?, "0")?;
    let timing = call(&get(&animation, "effect")?, "getTiming")?;
    get(&timing, "easing")?.as_string()
}

/// The angle to which the page has turned the wheel.
fn angle() -> Option<String> {
    let wheel = document().query_selector(".bench .twin-turning").ok()??;
    wheel.get_attribute("transform")
}

/// What turns the wheel.
#[derive(Clone, Copy, Debug)]
enum TurnedBy {
    /// An animation whose easing begins so.
    Browser(&'static str),
    /// The page, in the frames that it draws anyway.
    Page,
}

#[wasm_bindgen_test]
async fn a_page_whose_drawing_delays_the_wire_draws_less_and_says_why() {
    let bench = open("link-drawing").await;
    let mut ahead = Duration::ZERO;
    for (late_hz, text, turned) in [
        (0, "at the full frame rate", TurnedBy::Browser("linear")),
        (
            20,
            "at 30 fps to keep the wire on time",
            TurnedBy::Browser("steps("),
        ),
        (20, "at 20 fps to keep the wire on time", TurnedBy::Page),
        (20, "at 10 fps to keep the wire on time", TurnedBy::Page),
        // Drawing less has not helped, so it was not the cause.
        (20, "at the full frame rate", TurnedBy::Browser("linear")),
    ] {
        let mut drawing = String::new();
        let mut is_turned = false;
        for _ in 0..50 {
            spinning(&bench, late_hz, ahead);
            // The panel shows figures ten times a second.
            pause(120).await;
            drawing = bench.text("status", "Drawing");
            if drawing != text {
                ahead += Duration::from_secs(1);
                continue;
            }
            is_turned = match (easing(), turned) {
                (Some(easing), TurnedBy::Browser(by)) => easing.starts_with(by),
                (None, TurnedBy::Page) => {
                    let before = angle();
                    let turns = || angle() != before;
                    bench.until("the page to turn the wheel", turns).await;
                    true
                }
                _ => false,
            };
            if is_turned {
                break;
            }
        }
        assert_eq!(drawing, text);
        assert!(is_turned, "{text}: by {turned:?}");
    }
}

#[wasm_bindgen_test]
async fn a_high_loss_stands_out_in_the_header_with_the_panel_closed() {
    let bench = Bench::with_motor("link-loss", Mode::Velocity).await;
    let stands_out = || {
        let figure = document().query_selector(".link-loss.high");
        figure.unwrap().map(|figure| figure.text_content())
    };
    for (lost, shown) in [(20, None), (100, Some("10.0")), (0, None)] {
        report(&bench, |update| {
            update.motors[0].link.loss_per_mille = Some(lost);
        });
        bench
            .until("the loss", || stands_out().flatten().as_deref() == shown)
            .await;
    }
}
