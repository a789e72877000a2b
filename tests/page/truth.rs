//! What is no longer true is withdrawn, and what is not known is not shown as zero.

use motorlink_messages::{
    Connection, Notice,
    bus::{Activity, IdQueryOutcome, Sample},
    protocol::{Celsius, Instant, Mode},
};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::{
    bench::{Bench, document, motor, performance},
    tools::report,
};

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "milliseconds of a test"
)]
fn now() -> Instant {
    Instant::from_millis(performance().now() as u64)
}

fn answer() -> Sample {
    let last = motor(Mode::Velocity, Activity::Idle).last.unwrap();
    Sample { at: now(), ..last }
}

fn of_page(selector: &str) -> web_sys::Element {
    document().query_selector(selector).unwrap().unwrap()
}

fn gauge() -> Option<String> {
    of_page(".bench .gauge-fill").get_attribute("stroke-dasharray")
}

fn figures() -> String {
    of_page(".bench .twin-figures")
        .text_content()
        .unwrap_or_default()
}

/// The worker's last update has the last replies too.
#[wasm_bindgen_test]
async fn a_disconnected_motor_shows_no_figures_and_no_zero() {
    let bench = Bench::with_motor("truth-disconnected", Mode::Velocity).await;
    report(&bench, |update| {
        update.samples = vec![answer()];
        update.motors[0].temperature = Some((now(), Celsius::new(41)));
    });
    bench
        .until("the temperature", || gauge().as_deref() == Some("41 999"))
        .await;
    bench
        .until("the speed", || figures().contains("0 rpm"))
        .await;
    report(&bench, |update| {
        update.connection = Connection::Disconnected;
        update.motors.clear();
        update.samples = vec![answer()];
    });
    bench
        .until("no figure", || {
            bench.text("status", "Motion") == "No data" && figures() == "–––"
        })
        .await;
    bench
        .until("an empty gauge", || gauge().as_deref() == Some("0 999"))
        .await;
}

#[wasm_bindgen_test]
async fn no_motor_answers_is_withdrawn_when_one_does() {
    let bench = Bench::with_motor("truth-answers", Mode::Velocity).await;
    let notices = || bench.text("region", "Notices");
    report(&bench, |update| {
        update.notices = vec![Notice::IdQueryEnded(IdQueryOutcome::NoReply)];
    });
    bench
        .until("the alert", || notices().contains("No motors found"))
        .await;
    report(&bench, |update| update.samples = vec![answer()]);
    bench
        .until("it to go", || !notices().contains("No motors found"))
        .await;
}
