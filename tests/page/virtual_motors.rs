//! The choice of the virtual motors, and the names that they have.

use motorlink::Preferences;
use motorlink_messages::{
    Adapter, Connection, ToPage, ToWorker, Update, VirtualLine, VirtualMotors,
    bus::Activity,
    protocol::{Mode, family::Model},
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, EventInit, HtmlInputElement, HtmlSelectElement};

use crate::bench::{Bench, motor, now, performance};

const ROVER: VirtualLine = VirtualLine {
    motors: VirtualMotors::Four,
    model: Model::Ddsm400,
};

fn changed() -> Event {
    let init = EventInit::new();
    init.set_bubbles(true);
    Event::new_with_event_init_dict("change", &init).unwrap()
}

fn connected(connection: Connection) -> ToPage {
    let is_open = matches!(connection, Connection::Connected(_));
    let motor = motor(Mode::Velocity, Activity::Idle);
    ToPage::Update(Update {
        now: now(),
        connection,
        halted: false,
        motors: if is_open { vec![motor] } else { vec![] },
        job: None,
        raw: None,
        line: None,
        samples: vec![],
        notices: vec![],
    })
}

#[wasm_bindgen_test]
async fn the_chosen_virtual_motors_are_connected_then_and_later() {
    let bench = Bench::new("virtual-choice").await;
    bench.click("Virtual motors");
    let is_open = || !bench.find_all("region", "Virtual motors").is_empty();
    bench.until("the panel", is_open).await;
    let one: HtmlInputElement = bench.find("radio", "One motor").unchecked_into();
    assert!(one.checked());
    let rover: HtmlInputElement = bench.find("radio", "Four-wheel rover").unchecked_into();
    rover.set_checked(true);
    rover.dispatch_event(&changed()).unwrap();
    let model = bench.find("combobox", "Model of the virtual motors");
    let model: HtmlSelectElement = model.unchecked_into();
    model.set_value("ddsm400");
    model.dispatch_event(&changed()).unwrap();
    bench.received().await;
    bench.click("Connect virtual motors");
    let asked = ToWorker::ConnectVirtual(ROVER);
    assert!(bench.received().await.contains(&asked));
    bench.until("no panel", || !is_open()).await;
    assert_eq!(Preferences::load().virtual_line, ROVER);
    bench.click("Virtual motor");
    assert!(bench.received().await.contains(&asked));

    // Connected, it can be changed for another, not connected again.
    let time_origin_ms = performance().time_origin();
    bench.post(&ToPage::Hello { time_origin_ms });
    bench.post(&connected(Connection::Connected(Adapter::Virtual(ROVER))));
    let blocked = |name: &str| bench.find("button", name).has_attribute("disabled");
    bench
        .until("the rover", || {
            bench
                .text("status", "Connection")
                .contains("4 virtual DDSM400")
        })
        .await;
    bench.click("Virtual motors");
    bench.until("the panel", is_open).await;
    assert!(blocked("Virtual motor") && blocked("Connect virtual motors"));
    one.set_checked(true);
    one.dispatch_event(&changed()).unwrap();
    bench
        .until("another choice", || !blocked("Connect virtual motors"))
        .await;
    assert!(blocked("Virtual motor"));
    Preferences::default().save();
}

#[wasm_bindgen_test]
async fn a_virtual_rover_has_names_of_its_own() {
    let bench = Bench::with_motor("virtual-names", Mode::Velocity).await;
    let is_named = |name: &str| !bench.find_all("button", name).is_empty();
    bench.until("a motor", || is_named("Motor 0x01")).await;
    bench.post(&connected(Connection::Connected(Adapter::Virtual(ROVER))));
    bench
        .until("its name", || is_named("Motor 0x01, Front left, left"))
        .await;
    bench.post(&connected(Connection::Disconnected));
    bench.post(&connected(Connection::Connected(Adapter::Serial(None))));
    bench
        .until("the real motor", || is_named("Motor 0x01"))
        .await;
}
