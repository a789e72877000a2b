//! The setup of a rover's wheels: the commands that it sends, and the questions after each spin.

use motorlink_messages::{
    Notice,
    bus::{
        Activity, Answer, Command, Consent, JobStatus, ScanReport, StopOutcome, StopReason,
        StopReport,
    },
    protocol::{MotorId, Rpm, Setpoint, SpeedTarget},
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, EventInit, HtmlInputElement};

use crate::{
    bench::{Bench, pause, performance, text_of},
    tools::{id, report, standing, until_enabled},
};

const SPIN_RPM: i32 = 20;

fn store(progress: Option<&str>) {
    let storage = web_sys::window().unwrap().local_storage().unwrap().unwrap();
    for key in ["motorlink.wheel-setup", "motorlink.fleet"] {
        storage.remove_item(key).unwrap();
    }
    if let Some(progress) = progress {
        storage.set_item("motorlink.wheel-setup", progress).unwrap();
    }
}

fn stored() -> String {
    let storage = web_sys::window().unwrap().local_storage().unwrap().unwrap();
    storage.get_item("motorlink.wheel-setup").unwrap().unwrap()
}

/// The panel with this stored progress, and two motors at standstill.
async fn setup(name: &str, progress: Option<&str>) -> Bench {
    store(progress);
    let bench = crate::tools::open(name, "ID Manager").await;
    report(&bench, |update| {
        update.motors = vec![standing(1), standing(2)];
    });
    open(&bench).await;
    bench
}

async fn open(bench: &Bench) {
    bench.click("ID wizard");
    bench
        .until("the panel", || {
            !bench.find_all("status", "Wheel setup").is_empty()
        })
        .await;
}

fn said(bench: &Bench) -> String {
    bench.text("status", "Wheel setup")
}

async fn until_said(bench: &Bench, words: &str) {
    bench.until(words, || said(bench).contains(words)).await;
}

fn drive(motor: u8, rpm: i32) -> Command {
    Command::Start {
        id: id(motor),
        setpoint: Setpoint::velocity(SpeedTarget::clamped(rpm)),
        consent: Consent::None,
    }
}

fn stopped(motor: u8) -> Notice {
    Notice::StopEnded(StopReport {
        reason: StopReason::OneMotor,
        motors: vec![StopOutcome {
            id: id(motor),
            confirmed: true,
            speed: Some(Rpm::new(0)),
        }],
    })
}

const SPIN_STEP: &str = "spin\n1\tleft\tyes\tno\tPort\n2\tright\tyes\tno\tStarboard\n";

async fn both_at_standstill(bench: &Bench, notices: Vec<Notice>) {
    report(bench, |update| {
        update.motors = vec![standing(1), standing(2)];
        update.notices = notices;
    });
    pause(50).await;
}

#[wasm_bindgen_test]
async fn a_spin_lasts_half_a_second_and_the_page_asks_at_standstill() {
    let bench = setup("spin", Some(SPIN_STEP)).await;
    until_enabled(&bench, "Spin Starboard").await;
    assert_eq!(bench.commands().await, [], "nothing turns by itself");
    let pressed_ms = performance().now();
    bench.click("Spin Starboard");
    // A wheel on the right side turns forward at negative speeds of its motor.
    assert_eq!(bench.commands().await, [drive(2, -SPIN_RPM)]);
    report(&bench, |update| {
        let mut turning = standing(2);
        turning.activity = Activity::Driven {
            setpoint: Setpoint::velocity(SpeedTarget::clamped(-SPIN_RPM)),
        };
        update.motors = vec![standing(1), turning];
    });
    until_said(&bench, "Starboard is stopping").await;
    let took_ms = performance().now() - pressed_ms;
    assert!((500.0..1_500.0).contains(&took_ms), "{took_ms} ms");
    assert_eq!(bench.commands().await, [Command::Stop(id(2))]);
    assert!(bench.find_all("group", "What did you see?").is_empty());

    both_at_standstill(&bench, vec![stopped(2)]).await;
    until_said(&bench, "What did you see?").await;
    assert!(bench.find("button", "Spin Port").has_attribute("disabled"));
    pause(700).await;
    assert_eq!(
        bench.commands().await,
        [],
        "nothing is driven while the page asks"
    );
    bench.click("Turns backwards");
    until_said(&bench, "Side: left").await;
    assert!(
        stored().contains("2\tleft\tyes\tno\tStarboard"),
        "{}",
        stored()
    );

    // The side has changed, and with it the sign of forward.
    until_enabled(&bench, "Spin Starboard").await;
    bench.click("Spin Starboard");
    assert_eq!(bench.commands().await, [drive(2, SPIN_RPM)]);
    store(None);
}

#[wasm_bindgen_test]
async fn closing_the_panel_ends_a_spin_and_keeps_the_question() {
    let bench = setup("close", Some(SPIN_STEP)).await;
    until_enabled(&bench, "Spin Port").await;
    bench.click("Spin Port");
    bench.click("Close the panel");
    let commands = bench.commands().await;
    assert_eq!(commands, [drive(1, SPIN_RPM), Command::Stop(id(1))]);
    both_at_standstill(&bench, vec![stopped(1)]).await;
    open(&bench).await;
    until_said(&bench, "What did you see?").await;
    // For half a second after a start the page does not know whether the motor moves, and refuses to change sides.
    pause(500).await;
    bench.click("Another wheel turned");
    bench
        .until("the other wheels", || {
            !bench.find_all("button", "Starboard").is_empty()
        })
        .await;
    bench.click("Starboard");
    until_said(&bench, "The motors of Port and Starboard are swapped").await;
    assert!(stored().contains("2\tleft\tyes\tno\tPort"), "{}", stored());
    store(None);
}

#[wasm_bindgen_test]
async fn a_stop_ends_a_spin_and_keeps_the_step() {
    let bench = setup("stop-spin", Some(SPIN_STEP)).await;
    until_enabled(&bench, "Spin Port").await;
    bench.click("Spin Port");
    bench.click("STOP all motors");
    let stop = Command::StopAll(StopReason::Operator);
    assert_eq!(bench.commands().await, [drive(1, SPIN_RPM), stop]);
    report(&bench, |update| {
        update.motors = vec![standing(1), standing(2)];
        update.halted = true;
        update.notices = vec![Notice::StopBegan(StopReason::Operator)];
    });
    until_said(&bench, "Port was stopped early").await;
    pause(600).await;
    assert_eq!(
        bench.commands().await,
        [],
        "the timer of the spin does nothing"
    );
    assert!(bench.find("button", "Spin Port").has_attribute("disabled"));
    assert_eq!(stored(), SPIN_STEP);
    store(None);
}

#[wasm_bindgen_test]
async fn no_wheel_is_spun_while_a_motor_does_not_reply() {
    let bench = setup("silent", Some(SPIN_STEP)).await;
    until_enabled(&bench, "Spin Port").await;
    report(&bench, |update| {
        let mut silent = standing(2);
        silent.answer = Answer::Missing;
        update.motors = vec![standing(1), silent];
    });
    let port = || bench.find("button", "Spin Port");
    bench
        .until("the reason", || {
            port().title().contains("every motor replies")
        })
        .await;
    port().click();
    assert_eq!(bench.commands().await, []);
    store(None);
}

fn scanned(found: &[u8]) -> Notice {
    Notice::ScanEnded(ScanReport {
        found: found
            .iter()
            .map(|found| id(*found))
            .collect::<Vec<MotorId>>(),
        noisy: vec![],
        fault: None,
        asked: 254,
        complete: true,
        took_ms: 2_000,
    })
}

async fn scan(bench: &Bench, found: &[u8]) {
    report(bench, |update| {
        update.motors = vec![standing(1), standing(2)];
        update.job = Some(JobStatus::Scanning {
            asked: 118,
            of: 254,
            left_ms: 900,
            found: vec![id(1)],
        });
    });
    bench
        .until("the progress of the scan", || {
            text_of(&bench.find("region", "Set up the wheels of a rover")).contains("118 of 254")
        })
        .await;
    both_at_standstill(bench, vec![scanned(found)]).await;
}

#[wasm_bindgen_test]
async fn each_wheel_waits_for_its_only_motor_and_the_check_names_missing_motors() {
    let bench = setup("steps", None).await;
    bench.click("2 wheels");
    bench
        .until("two rows", || {
            bench.find_all("textbox", "Name of wheel 3").is_empty()
        })
        .await;
    let name: HtmlInputElement = bench.find("textbox", "Name of wheel 1").unchecked_into();
    name.set_value("Port");
    let bubbles = EventInit::new();
    bubbles.set_bubbles(true);
    let input = Event::new_with_event_init_dict("input", &bubbles).unwrap();
    name.dispatch_event(&input).unwrap();
    bench.click("Set the IDs");
    until_said(&bench, "Connect only the motor of Port").await;
    assert!(
        stored().starts_with("id 0\n1\tleft\tno\tno\tPort\n"),
        "{}",
        stored()
    );
    bench.click("Find and set ID");
    assert_eq!(bench.commands().await, [Command::FullScan]);
    scan(&bench, &[1, 2]).await;
    until_said(&bench, "2 motors found (0x01, 0x02)").await;

    // The motor has the ID already: nothing is set, and the label follows.
    bench.click("Find and set ID");
    assert_eq!(bench.commands().await, [Command::FullScan]);
    scan(&bench, &[1]).await;
    until_said(&bench, "Motor 0x01 already has this ID").await;
    assert_eq!(bench.commands().await, []);
    assert!(
        stored().starts_with("label 0\n1\tleft\tyes"),
        "{}",
        stored()
    );
    bench.click("Labelled: next wheel");
    until_said(&bench, "Connect only the motor of Right wheel").await;
    bench.click("Skip this wheel");
    until_said(&bench, "Connect all 2 motors").await;
    bench.click("Check all");
    assert_eq!(bench.commands().await, [Command::FullScan]);
    scan(&bench, &[1, 9]).await;
    until_said(&bench, "No reply from Right wheel (0x02)").await;
    assert!(said(&bench).contains("0x09"), "{}", said(&bench));
    let rows = text_of(&bench.find("list", "Wheels on the bus"));
    assert!(
        rows.contains("replies") && rows.contains("no reply"),
        "{rows}"
    );
    bench.click("Set ID of Right wheel");
    until_said(&bench, "Connect only the motor of Right wheel").await;
    store(None);
}

#[wasm_bindgen_test]
async fn a_declined_question_keeps_the_step() {
    let bench = setup(
        "declined",
        Some("id 1\n1\tleft\tyes\tno\tA\n5\tright\tno\tno\tB\n"),
    )
    .await;
    bench.click("Find and set ID");
    assert_eq!(bench.commands().await, [Command::FullScan]);
    scan(&bench, &[1]).await;
    let question = || bench.find_all("alertdialog", "Change the ID?");
    bench.until("the question", || question().len() == 1).await;
    crate::bench::press("Escape");
    until_said(&bench, "Cancelled: no ID was set").await;
    assert_eq!(bench.commands().await, []);
    assert!(stored().starts_with("id 1\n"), "{}", stored());
    store(None);
}
