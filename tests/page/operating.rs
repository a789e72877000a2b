//! What an operator does, and what the worker is received by it.

use motorlink_messages::{
    Adapter, Connection, Notice, ToPage, ToWorker,
    bus::{Activity, Command, Consent, IdQueryOutcome, StopReason},
    protocol::{Acceleration, CurrentTarget, Mode, MotorId, Setpoint, SpeedTarget},
};
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::Event;

use crate::{
    bench::{Bench, document, motor, press},
    tools::{id, report},
};

const ID: MotorId = MotorId::FIRST;
const STOP_ALL: Command = Command::StopAll(StopReason::Operator);

fn speed(rpm: i32) -> Setpoint {
    Setpoint::Velocity {
        speed: SpeedTarget::new(rpm).unwrap(),
        acceleration: Acceleration::FASTEST,
    }
}

fn drive(setpoint: Setpoint, consent: Consent) -> Command {
    Command::Start {
        id: ID,
        setpoint,
        consent,
    }
}

#[wasm_bindgen_test]
async fn a_stop_before_there_is_a_worker_stands_once_there_is() {
    let bench = Bench::after("early-stop", || press("Escape")).await;
    assert_eq!(bench.commands().await, [STOP_ALL]);
}

#[wasm_bindgen_test]
async fn a_ping_is_answered() {
    let bench = Bench::new("ping").await;
    bench.received().await;
    bench.post(&ToPage::Ping);
    let received = bench.received().await;
    assert!(
        matches!(received.as_slice(), [ToWorker::Pong { .. }]),
        "{received:?}"
    );
}

#[wasm_bindgen_test]
async fn plus_one_hundred_drives_at_one_hundred() {
    let bench = Bench::with_motor("plus-100", Mode::Velocity).await;
    bench.click("+100");
    bench.click("-50");
    let wanted = [100, -50].map(|rpm| drive(speed(rpm), Consent::None));
    assert_eq!(bench.commands().await, wanted);
}

#[wasm_bindgen_test]
async fn keys_drive_and_stop() {
    let bench = Bench::with_motor("keys", Mode::Velocity).await;
    press("2");
    press("b");
    press("s");
    press(" ");
    let wanted = [
        drive(speed(100), Consent::None),
        drive(speed(-100), Consent::None),
        Command::Stop(ID),
        STOP_ALL,
    ];
    assert_eq!(bench.commands().await, wanted);
}

#[wasm_bindgen_test]
async fn in_a_number_field_only_the_stop_keys_act() {
    let bench = Bench::with_motor("in-a-field", Mode::Velocity).await;
    bench.find("spinbutton", "Target speed").focus().unwrap();
    for key in ["1", "f", " ", "v", "Escape"] {
        press(key);
    }
    assert_eq!(bench.commands().await, [], "nothing is driven");
    let driven = Activity::Driven {
        setpoint: speed(100),
    };
    bench.report(motor(Mode::Velocity, driven), false);
    bench
        .until("+100 rpm", || document().title().contains("+100 rpm"))
        .await;
    for key in ["1", "f", " ", "v", "Escape"] {
        press(key);
    }
    assert_eq!(bench.commands().await, [STOP_ALL, STOP_ALL]);
}

#[wasm_bindgen_test]
async fn a_speed_out_of_range_is_kept_explained_and_not_sent() {
    let bench = Bench::with_motor("out-of-range", Mode::Velocity).await;
    let driven = Activity::Driven {
        setpoint: speed(100),
    };
    bench.report(motor(Mode::Velocity, driven), false);
    let title = || document().title();
    bench
        .until("the motor to be driven", || {
            title() == "● +100 rpm - MotorLink"
        })
        .await;

    let field = bench.enter("Target speed", "400");
    assert_eq!(bench.commands().await, []);
    assert_eq!(field.value(), "400");
    assert_eq!(field.get_attribute("aria-invalid").unwrap(), "true");
    let words = field.get_attribute("aria-describedby").unwrap();
    let words = document().get_element_by_id(&words).unwrap();
    let words = words.text_content().unwrap();
    assert!(words.contains("-330 to 330"), "{words}");
    assert!(bench.find("button", "Start").has_attribute("disabled"));

    // A wheel does not follow while a number is typed.
    let field = bench.enter("Target speed", "-120");
    assert_eq!(bench.commands().await, []);
    field.focus().unwrap();
    press("Enter");
    let adjusted = Command::Adjust {
        id: ID,
        setpoint: speed(-120),
        consent: Consent::None,
    };
    assert_eq!(bench.commands().await, [adjusted]);
}

#[wasm_bindgen_test]
async fn a_high_current_asks_first() {
    let bench = Bench::with_motor("high-current", Mode::Current).await;
    bench.enter("Raw current", "26000");
    bench.click("Start");
    assert_eq!(bench.commands().await, []);
    assert_eq!(bench.find_all("alertdialog", "High current").len(), 1);
    bench.click("Drive at +6.35 A");
    let setpoint = Setpoint::Current(CurrentTarget::new(26_000).unwrap());
    assert_eq!(
        bench.commands().await,
        [drive(setpoint, Consent::HighCurrent)]
    );
    assert_eq!(bench.find_all("alertdialog", "High current").len(), 0);
}

#[wasm_bindgen_test]
async fn a_target_current_is_entered_in_amps() {
    let bench = Bench::with_motor("amps", Mode::Current).await;
    bench.enter("Target current", "0.5");
    let torque = || bench.text("status", "Target torque");
    bench.until("the torque", || torque() == "+0.38 N·m").await;
    bench.click("Start");
    let setpoint = Setpoint::Current(CurrentTarget::new(2_048).unwrap());
    assert_eq!(bench.commands().await, [drive(setpoint, Consent::None)]);
}

/// The one that is asked for may be another motor behind a replug.
#[wasm_bindgen_test]
async fn a_question_about_a_motor_does_not_outlive_its_connection_or_its_choice() {
    for way in ["unplugged", "replugged", "other motor"] {
        let bench = Bench::with_motor(&format!("consent {way}"), Mode::Current).await;
        bench.enter("Raw current", "26000");
        bench.click("Start");
        let asked = || bench.find_all("alertdialog", "High current").len() == 1;
        bench.until("the question", asked).await;
        report(&bench, |update| {
            update.motors = vec![motor(Mode::Current, Activity::Idle)];
            match way {
                "unplugged" => update.connection = Connection::Reconnecting(Adapter::VIRTUAL),
                "replugged" => {
                    let lost = Notice::AdapterLost { driven: vec![] };
                    update.notices = vec![lost, Notice::AdapterBack];
                }
                _ => {
                    update.motors[0].id = id(2);
                    let found = IdQueryOutcome::One(id(2));
                    update.notices = vec![Notice::IdQueryEnded(found)];
                }
            }
        });
        bench.until("no question", || !asked()).await;
        bench.report(motor(Mode::Current, Activity::Idle), false);
        let commands = bench.commands().await;
        let drives = |command: &Command| matches!(command, Command::Start { .. });
        assert!(!commands.iter().any(drives), "{way}: {commands:?}");
        assert!(!asked(), "{way}");
    }
    motorlink::Preferences::default().save();
}

/// One that reports an error may drive on.
#[wasm_bindgen_test]
async fn a_worker_that_fails_is_ended_before_the_page_says_so() {
    let bench = Bench::with_motor("failing", Mode::Velocity).await;
    let setpoint = speed(100);
    bench.report(motor(Mode::Velocity, Activity::Driven { setpoint }), false);
    let title = || document().title();
    bench
        .until("the motor to be driven", || title().contains("+100 rpm"))
        .await;
    assert!(bench.is_up().await);
    bench.fail();
    let said = || bench.text("region", "Notices");
    bench
        .until("the words", || said().contains("worker has stopped"))
        .await;
    assert!(!bench.is_up().await);
}

#[wasm_bindgen_test]
async fn after_a_stop_a_person_has_to_release() {
    let bench = Bench::with_motor("release", Mode::Velocity).await;
    bench.report(motor(Mode::Velocity, Activity::Idle), true);
    bench
        .until("the dialog", || {
            bench.find_all("alertdialog", "Stopped").len() == 1
        })
        .await;
    assert!(bench.find("button", "+100").title().contains("Release"));
    // Space pressed again stops again and releases nothing.
    press(" ");
    assert_eq!(bench.commands().await, [STOP_ALL]);
    bench.click("Release");
    assert_eq!(bench.commands().await, [Command::Release]);
}

#[wasm_bindgen_test]
async fn a_page_that_goes_stops_the_motors() {
    let bench = Bench::with_motor("pagehide", Mode::Velocity).await;
    let window = web_sys::window().unwrap();
    let goes = Event::new("pagehide").unwrap();
    window.dispatch_event(&goes).unwrap();
    let stop = Command::StopAll(StopReason::PageGone);
    assert_eq!(bench.commands().await, [stop]);
}
