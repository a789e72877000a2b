//! The first screen: what there is while no port is open.

use motorlink::Preferences;
use motorlink_messages::{
    Adapter, LineCondition, ToPage, ToWorker, VirtualLine, VirtualMotors, bus::Activity,
    protocol::Mode,
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::HtmlElement;

use crate::bench::{Bench, document, motor, performance, text_of};

fn all(selector: &str) -> Vec<HtmlElement> {
    let found = document().query_selector_all(selector).unwrap();
    let found = (0..found.length()).filter_map(|place| found.get(place));
    found.map(JsCast::unchecked_into).collect()
}

#[wasm_bindgen_test]
async fn the_first_screen_has_one_primary_button_and_nothing_disabled() {
    let bench = Bench::new("first-screen").await;
    let headings = all(".first-screen h2, .to-try h2");
    let headings: Vec<String> = headings.iter().map(text_of).collect();
    assert_eq!(
        headings,
        [
            "Drive your hub motor from the browser",
            "Try a virtual motor",
            "Wiring",
            "Recording"
        ]
    );
    for name in [
        "Connect motor",
        "Virtual motor",
        "Virtual motors",
        "Other port",
        "One wheel",
        "Rover",
        "Faulty cable",
        "Open recording",
    ] {
        bench.find("button", name);
    }
    let primary = all(":is(.first-screen, .to-try) .primary");
    let primary: Vec<String> = primary.iter().map(text_of).collect();
    assert_eq!(primary, ["Connect motor"]);
    assert_eq!(all(":is(.first-screen, .to-try) :disabled").len(), 0);
}

#[wasm_bindgen_test]
async fn a_card_connects_its_motors_and_the_first_screen_goes() {
    let bench = Bench::new("first-cards").await;
    let line = |motors| VirtualLine {
        motors,
        ..VirtualLine::DEFAULT
    };
    bench.received().await;
    bench.click("Rover");
    let rover = ToWorker::ConnectVirtual(line(VirtualMotors::Four));
    assert!(bench.received().await.contains(&rover));
    bench.click("Faulty cable");
    let one = ToWorker::ConnectVirtual(line(VirtualMotors::One));
    let fault = ToWorker::VirtualWire(LineCondition::NoiseGrowsWithSpeed);
    let received = bench.received().await;
    assert!(received.contains(&one), "{received:?}");
    assert!(!received.contains(&fault), "no cable is there yet");

    let time_origin_ms = performance().time_origin();
    bench.post(&ToPage::Hello { time_origin_ms });
    let idle = motor(Mode::Velocity, Activity::Idle);
    bench.report_on(Adapter::VIRTUAL, idle, false);
    bench
        .until("the desk", || bench.find_all("button", "Rover").is_empty())
        .await;
    bench.find("button", "Disconnect");
    let received = bench.received().await;
    let faults = received.iter().filter(|message| **message == fault);
    assert_eq!(faults.count(), 1, "{received:?}");
    Preferences::default().save();
}
