//! The help: fetched, opened at a place, with the motor's own frames; and the tour of the first minutes.

use js_sys::Function;
use motorlink_messages::{
    Adapter, ConnectError, Connection, ToWorker, VirtualLine,
    bus::{Activity, Command, Consent},
    protocol::{Faults, Mode, MotorId, Rpm, Setpoint, SpeedTarget},
};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::HtmlInputElement;

use crate::{
    bench::{Bench, document, motor},
    tools::report,
};

const ENGLISH: &str = include_str!("../../public/help/en.html");
const DRAWING: &str = include_str!("../../public/help/wiring.svg");

/// A host that has the help's files. The test runner's has not.
struct Host {
    before: JsValue,
}

impl Host {
    fn with_help() -> Self {
        let window = web_sys::window().unwrap();
        let before = js_sys::Reflect::get(&window, &"fetch".into()).unwrap();
        let fetch = Function::new_with_args(
            "address",
            "const files = globalThis.helpFiles;
             const name = address.split('/').pop();
             return Promise.resolve(new Response(files[name] ?? '', { status: files[name] ? 200 : 404 }));",
        );
        let files = js_sys::Object::new();
        js_sys::Reflect::set(&files, &"en.html".into(), &ENGLISH.into()).unwrap();
        js_sys::Reflect::set(&files, &"wiring.svg".into(), &DRAWING.into()).unwrap();
        js_sys::Reflect::set(&window, &"helpFiles".into(), &files).unwrap();
        js_sys::Reflect::set(&window, &"fetch".into(), &fetch).unwrap();
        Self { before }
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        let window = web_sys::window().unwrap();
        js_sys::Reflect::set(&window, &"fetch".into(), &self.before).unwrap();
    }
}

fn focused() -> String {
    document().active_element().unwrap().id()
}

fn remembered() -> Option<String> {
    let storage = web_sys::window().unwrap().local_storage().unwrap().unwrap();
    storage.get_item("motorlink.tour").unwrap()
}

fn forget() {
    let storage = web_sys::window().unwrap().local_storage().unwrap().unwrap();
    storage.remove_item("motorlink.tour").unwrap();
}

#[wasm_bindgen_test]
async fn an_error_leads_to_its_place_in_the_help_and_a_help_that_is_missing_is_tried_again() {
    let bench = Bench::new("help-topic").await;
    report(&bench, |update| {
        update.connection = Connection::Failed(ConnectError::OpenFailed);
    });
    let link = "Help: the port does not open";
    bench
        .until("the way to the help", || {
            !bench.find_all("button", link).is_empty()
        })
        .await;
    bench.click(link);
    bench
        .until("the failure", || {
            !bench.find_all("button", "Retry").is_empty()
        })
        .await;
    let host = Host::with_help();
    bench.click("Retry");
    bench
        .until("the place to have the focus", || {
            focused() == "port-does-not-open"
        })
        .await;
    assert!(bench.find_all("button", "Retry").is_empty());
    assert!(
        document()
            .query_selector(".wiring-drawing svg")
            .unwrap()
            .is_some()
    );
    // A link within the help moves the focus too, and no address.
    let before = web_sys::window().unwrap().location().href().unwrap();
    let link = document()
        .query_selector(".help-nav a[href='#keys']")
        .unwrap()
        .unwrap();
    link.unchecked_into::<web_sys::HtmlElement>().click();
    bench.until("the keys", || focused() == "keys").await;
    assert_eq!(
        web_sys::window().unwrap().location().href().unwrap(),
        before
    );
    bench.click("Close");
    bench
        .until("the page", || bench.find_all("dialog", "Help").is_empty())
        .await;
    drop(host);
}

#[wasm_bindgen_test]
async fn the_protocol_card_shows_the_motors_own_frames_and_marks_examples() {
    let host = Host::with_help();
    let bench = Bench::with_motor("help-live", Mode::Velocity).await;
    bench.click("Help");
    let frame = |kind: &str| {
        let selector = format!("[data-live={kind}]");
        let code = document().query_selector(&selector).unwrap()?;
        let live = code.parent_element().unwrap().class_name() == "frame live";
        Some((code.text_content().unwrap(), live))
    };
    let heard = motor(Mode::Velocity, Activity::Idle).last.unwrap();
    let own = (heard.reply.frame().to_string(), true);
    bench
        .until("the motor's reply", || {
            frame("query-reply") == Some(own.clone())
        })
        .await;
    let (_, live) = frame("drive").unwrap();
    assert!(!live, "nobody has driven it");
    let mut driven = motor(Mode::Velocity, Activity::Idle);
    driven.activity = Activity::Driven {
        setpoint: Setpoint::velocity(SpeedTarget::clamped(-50)),
    };
    bench.report(driven, false);
    let asked = || frame("drive").unwrap();
    bench.until("the drive frame", || asked().1).await;
    assert!(asked().0.starts_with("01 64 FF CE"), "{}", asked().0);
    drop(host);
}

#[wasm_bindgen_test]
async fn the_tour_leads_through_a_first_spin_and_never_drives_by_itself() {
    forget();
    let bench = Bench::new("tour").await;
    let said = || bench.text("status", "First spin");
    let is_shown = || !bench.find_all("status", "First spin").is_empty();
    assert!(!is_shown(), "the first screen has its first steps");
    bench.click("Help");
    bench
        .until("the help", || !bench.find_all("button", "Tour").is_empty())
        .await;
    bench.click("Tour");
    bench
        .until("the tour", || is_shown() && said().contains("Signal plug"))
        .await;
    bench.click("Go virtual");
    assert!(
        bench
            .received()
            .await
            .contains(&ToWorker::ConnectVirtual(VirtualLine::DEFAULT))
    );

    let real = Adapter::Serial(None);
    bench.report_on(real, motor(Mode::Velocity, Activity::Idle), false);
    bench
        .until("the wheel to be freed", || said().contains("fasten"))
        .await;
    assert!(bench.find_all("button", "Spin at 20 rpm").is_empty());
    bench.received().await;
    let tick: HtmlInputElement = document()
        .get_element_by_id("tour-free")
        .unwrap()
        .unchecked_into();
    tick.click();
    bench
        .until("the spin", || {
            !bench.find_all("button", "Spin at 20 rpm").is_empty()
        })
        .await;
    assert_eq!(bench.commands().await, [], "a tick drives nothing");
    bench.click("Spin at 20 rpm");
    let commands = bench.commands().await;
    let [
        Command::Start {
            id,
            setpoint,
            consent,
        },
    ] = commands.as_slice()
    else {
        panic!("{commands:?}");
    };
    assert_eq!((*id, *consent), (MotorId::FIRST, Consent::None));
    assert!(
        matches!(setpoint, Setpoint::Velocity { speed, .. } if *speed == SpeedTarget::clamped(20))
    );

    let mut turning = motor(
        Mode::Velocity,
        Activity::Driven {
            setpoint: *setpoint,
        },
    );
    turning.speed = turning.speed.map(|(at, _)| (at, Rpm::new(20)));
    bench.report_on(real, turning, false);
    bench
        .until("the stop", || {
            !bench.find_all("button", "Stop the wheel").is_empty()
        })
        .await;
    bench.click("Stop the wheel");
    assert_eq!(bench.commands().await, [Command::Stop(MotorId::FIRST)]);
    assert_eq!(remembered(), None);
    bench.report_on(real, motor(Mode::Velocity, Activity::Idle), false);
    bench
        .until("the end", || {
            !bench.find_all("button", "End the tour").is_empty()
        })
        .await;
    assert_eq!(remembered().as_deref(), Some("seen"));
    bench.click("End the tour");
    bench
        .until("it to go", || {
            bench.find_all("status", "First spin").is_empty()
        })
        .await;
    assert!(bench.text("region", "Notices").contains("press +50"));

    bench.click("Help");
    bench
        .until("the help", || !bench.find_all("button", "Tour").is_empty())
        .await;
    bench.click("Tour");
    bench
        .until("the tour to be there", || {
            !bench.find_all("status", "First spin").is_empty()
        })
        .await;
    bench
        .until("the tour again", || said().contains("fasten"))
        .await;
    assert!(!tick.checked(), "what was confirmed is confirmed again");
}

#[wasm_bindgen_test]
async fn a_tour_that_was_skipped_stays_away_and_says_why_it_cannot_spin() {
    forget();
    let bench = Bench::with_motor("tour-skipped", Mode::Velocity).await;
    let mut stalled = motor(Mode::Velocity, Activity::Idle);
    if let Some(sample) = &mut stalled.last {
        sample.reply.faults = Faults::from_byte(8);
    }
    // A virtual motor needs no tick.
    bench.report(stalled, false);
    let spin = || bench.find_all("button", "Spin at 20 rpm").pop();
    let is_refused = || spin().is_some_and(|spin| spin.has_attribute("disabled"));
    bench.until("no spin", is_refused).await;
    let spin = spin().unwrap();
    assert!(spin.title().contains("stall"), "{}", spin.title());
    bench.click("Skip the tour");
    bench
        .until("it to go", || {
            bench.find_all("status", "First spin").is_empty()
        })
        .await;
    drop(bench);
    let again = Bench::new("tour-skipped-again").await;
    assert!(again.find_all("status", "First spin").is_empty());
}
