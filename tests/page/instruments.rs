//! What the cards show of the reports between two frames, and of what is over.

use js_sys::Date;
use motorlink_messages::{
    Adapter, Connection, ToPage, Update,
    bus::{Activity, MotorStatus, Sample, Turns},
    protocol::{
        Celsius, Current, Detail, Fault, Faults, Instant, Mode, MotorId, Position, Reply, Rpm,
    },
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Element, HtmlButtonElement};

use crate::bench::{Bench, motor};

const NO_FAULT: &str = "No faults recorded";
const STALL: Faults = Faults::NONE.with(Fault::Stall);

/// Milliseconds of the page's clock, which in these tests is the worker's too.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "milliseconds of a test"
)]
fn now_ms() -> u64 {
    let performance = web_sys::window().unwrap().performance().unwrap();
    performance.now() as u64
}

fn sample(id: MotorId, at_ms: u64, rpm: i16, degrees: u16, faults: Faults) -> Sample {
    let raw = u32::from(degrees) * 32_767 / 360;
    Sample {
        at: Instant::from_millis(at_ms),
        reply: Reply {
            id,
            mode: Mode::Velocity,
            current: Some(Current::from_raw(0)),
            speed: Some(Rpm::new(rpm)),
            detail: Detail::Drive {
                position: Position::from_raw(u16::try_from(raw).unwrap()),
            },
            faults,
        },
    }
}

/// Standing, with these faults, `ages` milliseconds ago.
fn faults(id: MotorId, received: &[(u64, Faults)]) -> Vec<Sample> {
    let now_ms = now_ms();
    received
        .iter()
        .map(|(age_ms, faults)| sample(id, now_ms - age_ms, 0, 0, *faults))
        .collect()
}

fn report(bench: &Bench, motor: MotorStatus, samples: Vec<Sample>) {
    bench.post(&ToPage::Update(Update {
        now: Instant::from_millis(now_ms()),
        connection: Connection::Connected(Adapter::VIRTUAL),
        halted: false,
        motors: vec![motor],
        job: None,
        raw: None,
        line: None,
        samples,
        notices: vec![],
    }));
}

fn standing() -> MotorStatus {
    motor(Mode::Velocity, Activity::Idle)
}

fn drawing(bench: &Bench, selector: &str) -> Element {
    let cards = bench.find("region", "Telemetry");
    cards.query_selector(selector).unwrap().unwrap()
}

/// `13:02:11`
fn local_time(page_ms: u64) -> String {
    let performance = web_sys::window().unwrap().performance().unwrap();
    #[allow(clippy::cast_precision_loss, reason = "milliseconds of a test")]
    let date = Date::new(&(performance.time_origin() + page_ms as f64).into());
    format!(
        "{:02}:{:02}:{:02}",
        date.get_hours(),
        date.get_minutes(),
        date.get_seconds()
    )
}

#[wasm_bindgen_test]
async fn a_fault_of_a_single_reply_between_two_frames_is_told_until_it_is_seen() {
    let bench = Bench::with_motor("one-fault", Mode::Velocity).await;
    assert_eq!(bench.text("status", "Fault record"), NO_FAULT);
    let seen: HtmlButtonElement = bench.find("button", "Acknowledge").unchecked_into();
    assert!(seen.disabled() && !seen.title().is_empty());

    let received = [(40, Faults::NONE), (30, STALL), (20, Faults::NONE)];
    let samples = faults(MotorId::FIRST, &received);
    let times = [1, 2].map(|place: usize| local_time(samples[place].at.as_micros() / 1000));
    report(&bench, standing(), samples);
    let wanted = format!("Last: stall, {} – {}", times[0], times[1]);
    bench
        .until("the fault", || {
            bench.text("status", "Fault record") == wanted
        })
        .await;
    assert_eq!(bench.text("status", "Faults"), "OK 0x00", "it is over");

    bench.until("the button", || !seen.disabled()).await;
    bench.click("Acknowledge");
    bench
        .until("it to go", || {
            bench.text("status", "Fault record") == NO_FAULT
        })
        .await;
    assert!(seen.disabled());
}

#[wasm_bindgen_test]
async fn a_fault_that_is_there_stays_until_it_goes_though_it_was_seen() {
    let bench = Bench::with_motor("active-fault", Mode::Velocity).await;
    report(&bench, standing(), faults(MotorId::FIRST, &[(10, STALL)]));
    let record = || bench.text("status", "Fault record");
    bench
        .until("the fault", || record().contains("stall, since"))
        .await;
    bench.click("Acknowledge");
    let seen: HtmlButtonElement = bench.find("button", "Acknowledge").unchecked_into();
    bench.until("the mark", || seen.disabled()).await;
    assert!(record().contains("stall, since"), "{}", record());
    report(
        &bench,
        standing(),
        faults(MotorId::FIRST, &[(1, Faults::NONE)]),
    );
    bench.until("it to go", || record() == NO_FAULT).await;
}

#[wasm_bindgen_test]
async fn the_faults_of_another_motor_are_not_shown() {
    let bench = Bench::with_motor("other-fault", Mode::Velocity).await;
    let other = MotorId::new(2).unwrap();
    let mut samples = faults(other, &[(30, STALL)]);
    samples.extend(faults(
        MotorId::FIRST,
        &[(20, Faults::NONE.with(Fault::Sensor))],
    ));
    report(&bench, standing(), samples);
    let record = || bench.text("status", "Fault record");
    bench.until("its own", || record().contains("sensor")).await;
    assert!(!record().contains("stall"), "{}", record());
}

#[wasm_bindgen_test]
async fn a_spike_of_one_reply_is_in_the_sparkline() {
    let bench = Bench::with_motor("spike", Mode::Velocity).await;
    let now_ms = now_ms();
    let samples = (0..100).map(|place| {
        let rpm = if place == 50 { 330 } else { 10 };
        sample(
            MotorId::FIRST,
            now_ms - 200 + place * 2,
            rpm,
            0,
            Faults::NONE,
        )
    });
    report(&bench, standing(), samples.collect());
    // The status of the motor never says it.
    let scale = || drawing(&bench, ".speed .spark-scale").get_attribute("data-scale");
    bench
        .until("the scale", || scale().as_deref() == Some("±400"))
        .await;
    let line = drawing(&bench, ".speed .spark-line")
        .get_attribute("d")
        .unwrap();
    // 330 of 400, where 0 is at 500 and 400 at 40.
    assert!(line.contains(" 121") || line.contains("V121"), "{line}");
}

#[wasm_bindgen_test]
async fn position_is_told_in_degrees_raw_and_turns_and_mirrored() {
    let bench = Bench::with_motor("turns", Mode::Velocity).await;
    // One turn and a quarter at -60 rpm: the angle grows.
    let now_ms = now_ms();
    let samples = (0..=125_u16).map(|place| {
        let at_ms = now_ms - 1_250 + u64::from(place) * 10;
        let degrees = (u32::from(place) * 360 / 100) % 360;
        let rpm = if place == 125 { 0 } else { -60 };
        sample(
            MotorId::FIRST,
            at_ms,
            rpm,
            u16::try_from(degrees).unwrap(),
            Faults::NONE,
        )
    });
    let mut motor = standing();
    let there = Position::from_raw(8_191);
    motor.position = Some((Instant::from_millis(now_ms + 60_000), there));
    motor.turns = Some(Turns::new(-1.25));
    report(&bench, motor, samples.collect());
    let position = || bench.text("status", "Position");
    bench
        .until("the position", || position().starts_with("90.0° raw 8191"))
        .await;
    let hand = || {
        let turned = drawing(&bench, ".angle-hand").get_attribute("transform");
        turned.unwrap_or_default()
    };
    // 1.25 turns, to a tenth. It goes on reporting, or the drawn wheel would stop where it is.
    bench
        .until("the turns and the hand", || {
            let standing = sample(MotorId::FIRST, self::now_ms(), 0, 90, Faults::NONE);
            report(&bench, motor, vec![standing]);
            let turned = ["\u{2212}1.2 turns", "\u{2212}1.3 turns"]
                .iter()
                .any(|turns| position().ends_with(turns));
            turned
                && ["rotate(89.9", "rotate(90.0"]
                    .iter()
                    .any(|at| hand().starts_with(at))
        })
        .await;
}

#[wasm_bindgen_test]
async fn a_hot_winding_is_told_in_words_too() {
    let bench = Bench::with_motor("hot", Mode::Velocity).await;
    let temperature = || bench.text("status", "Temperature");
    for (degrees, band, words) in [
        (69, "normal", "69 °C limit 75 °C"),
        (70, "warm", "70 °C warm limit 75 °C"),
        (80, "hot", "80 °C too hot limit 75 °C"),
    ] {
        let mut motor = standing();
        let at = Instant::from_millis(now_ms() + 60_000);
        motor.temperature = Some((at, Celsius::new(degrees)));
        report(&bench, motor, vec![]);
        bench.until(words, || temperature() == words).await;
        let gauge = || drawing(&bench, ".gauge").get_attribute("data-band");
        bench.until(band, || gauge().as_deref() == Some(band)).await;
    }
}
