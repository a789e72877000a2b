//! Stops of 2 to 16 virtual motors from each loop, in virtual time: when each is braked, and when all are confirmed.
//!
//! `cargo xtask bench stops` writes its rows into docs/performance.md. The adapter holds received bytes for 1 or 16 ms.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    missing_docs,
    reason = "a measurement that cannot go on ends"
)]

#[path = "../tests/fixture/mod.rs"]
mod fixture;

use std::time::Duration;

use motorlink_protocol::{Mode, family::Model};

use fixture::measured_stops::{MeasuredStop, Stopped, loops, measure};

/// What issue 32 asks of eight motors, and of the end of any stop.
const EIGHT_BRAKED: Duration = Duration::from_millis(150);
const CONFIRMED: Duration = Duration::from_millis(1_500);

fn main() {
    for model in Model::ALL {
        for mode in loops(model) {
            for hold_ms in [1, 16] {
                row(model, mode, hold_ms);
            }
        }
    }
}

fn row(model: Model, mode: Mode, hold_ms: u64) {
    // The bus asks for the loop of a motor with separate frames before it drives it, so that not more of them can be driven.
    let most = if model.has_separate_frames() && hold_ms > 1 {
        4
    } else {
        16
    };
    let motors: Vec<u8> = [2, 4, 8, 16]
        .into_iter()
        .filter(|motors| *motors <= most)
        .collect();
    let stop = |motors: &u8| {
        measure(Stopped {
            model,
            mode,
            motors: *motors,
            hold: Duration::from_millis(hold_ms),
            switch_frames: 1,
        })
    };
    let stops: Vec<MeasuredStop> = motors.iter().map(stop).collect();
    let braked: Vec<Option<Duration>> = stops.iter().map(MeasuredStop::last_first_brake).collect();
    let confirmed: Vec<Option<Duration>> = stops.iter().map(|stop| stop.confirmed).collect();
    let within = |motors: u8, braked: Option<Duration>| match (motors, braked) {
        (_, None) => false,
        (..=8, Some(braked)) => braked <= EIGHT_BRAKED,
        (_, Some(braked)) => braked <= motorlink_bus::FIRST_BRAKE_MAX,
    };
    let reached = motors
        .iter()
        .zip(&braked)
        .all(|(motors, it)| within(*motors, *it))
        && confirmed
            .iter()
            .all(|it| it.is_some_and(|it| it <= CONFIRMED));
    println!(
        "| stop of {} {model} from the {mode}, adapter that holds bytes for {hold_ms} ms: first brake to the last of them, \
         all confirmed | 150 ms at 8 motors, {} ms at 16; 1.5 s | {}; {} | {} |",
        motors
            .iter()
            .map(u8::to_string)
            .collect::<Vec<_>>()
            .join(", "),
        motorlink_bus::FIRST_BRAKE_MAX.as_millis(),
        list(&braked),
        list(&confirmed),
        if reached { "yes" } else { "NO" }
    );
}

fn list(times: &[Option<Duration>]) -> String {
    let text = |time: &Option<Duration>| match time {
        Some(time) => format!("{} ms", time.as_millis()),
        None => "never".to_owned(),
    };
    times.iter().map(text).collect::<Vec<_>>().join(", ")
}
