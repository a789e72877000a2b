//! A wheel that turns though nothing here drives it.

use motorlink_messages::{
    bus::{Activity, Command, MotorStatus, RawStatus, StopReason},
    protocol::{Mode, MotorId, Rpm},
};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::{
    bench::{Bench, dispatch_key, document, motor},
    tools::report,
};

const STOP_ALL: Command = Command::StopAll(StopReason::Operator);

fn turning() -> MotorStatus {
    let mut motor = motor(Mode::Velocity, Activity::Idle);
    motor.turns_unasked = true;
    motor.speed = motor.speed.map(|(at, _)| (at, Rpm::new(100)));
    motor
}

fn is_shown() -> bool {
    let alert = document().query_selector(".turns-unasked").unwrap();
    alert.is_some_and(|alert| !alert.has_attribute("hidden"))
}

async fn with_turning(name: &str) -> Bench {
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    bench.report(turning(), false);
    bench.until("the alert", is_shown).await;
    bench.received().await;
    bench
}

#[wasm_bindgen_test]
async fn a_wheel_that_turns_unasked_is_an_alert_with_its_speed_until_it_stands() {
    let bench = with_turning("unasked-alert").await;
    let alert = document()
        .query_selector(".turns-unasked")
        .unwrap()
        .unwrap();
    let words = alert.text_content().unwrap();
    assert!(
        words.contains("Motor 0x01 is turning, and nothing here drives it"),
        "{words}"
    );
    assert!(words.contains("+100 rpm"), "{words}");
    assert_eq!(bench.commands().await, [], "nothing is done by itself");
    bench.click("Stop it");
    assert_eq!(bench.commands().await, [Command::Stop(MotorId::FIRST)]);
    bench.report(motor(Mode::Velocity, Activity::Idle), false);
    bench.until("no alert", || !is_shown()).await;
}

#[wasm_bindgen_test]
async fn space_and_escape_stop_a_wheel_that_turns_unasked() {
    let bench = with_turning("unasked-keys").await;
    bench.find("button", "+50").focus().unwrap();
    for key in [" ", "Escape"] {
        assert!(!dispatch_key("keydown", key, false), "{key}");
        assert!(!dispatch_key("keyup", key, false), "{key}");
        assert_eq!(bench.commands().await, [STOP_ALL], "{key}");
    }
}

#[wasm_bindgen_test]
async fn a_wheel_that_a_raw_frame_has_left_running_is_an_alert_in_other_places() {
    let bench = Bench::with_motor("unasked-raw", Mode::Velocity).await;
    report(&bench, |update| {
        update.raw = Some(RawStatus {
            frame: "01 64 00 32 00 00 00 00 00 D3".parse().unwrap(),
            count: 1,
            sent: 1,
            answered: 1,
            running: false,
            last: None,
        });
        let motor = &mut update.motors[0];
        motor.may_turn = true;
        motor.speed = motor.speed.map(|(at, _)| (at, Rpm::new(50)));
    });
    bench.until("the alert", is_shown).await;
    bench.received().await;
    bench.click("Stop it");
    assert_eq!(bench.commands().await, [Command::Stop(MotorId::FIRST)]);
}
