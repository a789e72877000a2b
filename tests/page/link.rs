//! The panel Link: the line in figures, the doctor, and the virtual motor's wire.

use motorlink_messages::{
    Adapter, Connection, ToWorker, VirtualWire,
    bus::{Counters, LineStatus, RoundTripStatus},
    protocol::Mode,
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, EventInit, HtmlSelectElement};

use crate::{
    bench::{Bench, text_of},
    tools::tell,
};

async fn open(name: &str) -> Bench {
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    bench.click("Link");
    let there = || !bench.find_all("combobox", "Simulated fault").is_empty();
    bench.until("the panel", there).await;
    bench
}

/// The line as it is when motor 1 was asked so often and answered none.
fn silent(bench: &Bench, requests: u64) {
    tell(bench, |update| {
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
        update.motors[0].silent = requests > 0;
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
    let doctor = || bench.text("", "Link diagnosis");
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
    assert_eq!(bars.query_selector_all("text").unwrap().length(), 11);
    assert_eq!(doctor(), "Not enough data for a diagnosis yet.");
    silent(&bench, 30);
    bench
        .until("the table", || {
            bench
                .text("", "Motors on the bus")
                .contains("0x01030000Others")
        })
        .await;
    bench
        .until("the diagnosis", || doctor().starts_with("No bytes"))
        .await;
    let panel = bench.find("region", "Link");
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
    let told = bench.told().await;
    assert!(
        told.contains(&ToWorker::VirtualWire(VirtualWire::SharedId)),
        "{told:?}"
    );
    assert_eq!(wire().value(), "3");
    tell(&bench, |update| {
        update.connection = Connection::Connected(Adapter::Serial(None));
    });
    bench.until("it to be disabled", || wire().disabled()).await;
    assert!(!wire().title().is_empty());
    bench
        .until("it to be forgotten", || wire().value() == "0")
        .await;
}
