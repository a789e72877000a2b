//! Generates programs from a sequence, and the files of a robot for ROS 2.
//!
//! Each program asks before it moves anything. That in Python needs the package `motorlink`. The sketch for Arduino stands
//! alone: it sends setpoints as the runner does, and checks the limits of the
//! run, faults and silence. At its end, on an error and on Ctrl-C it stops every motor: it switches to the velocity
//! loop until the motor reports it, and brakes until three replies in a row report a standstill.

mod python;
mod ros2;
mod rows;

use std::fmt::Write;

pub use python::python;
pub use ros2::{Robot, RobotFiles, UnevenSides, ros2};

use crate::{
    plan::{Plan, PlanMotor},
    sequence::Sequence,
};

const ARDUINO: &str = include_str!("program.ino");

/// Time for one exchange with a motor, which takes 2.4 ms, with a margin for a slow adapter.
const EXCHANGE_MS: usize = 4;
/// Shortest period between two rounds: 100 setpoints a second, which every adapter supports.
const PERIOD_MIN_MS: usize = 10;

/// The input of a generator.
#[derive(Clone, Copy, Debug)]
pub struct Program<'a> {
    /// The plan to run.
    pub plan: &'a Plan,
    /// The sequence that it was made of.
    pub sequence: &'a Sequence,
    /// The serial port, such as `/dev/ttyUSB0`.
    pub port: &'a str,
}

/// An Arduino sketch for an ESP32 with an RS485 transceiver.
#[must_use]
pub fn arduino(program: &Program<'_>) -> String {
    let motors = program.plan.motors.iter();
    let motors = motors.map(|motor| {
        format!(
            "{{{}, {}, {}}}",
            motor.id.get(),
            motor.mode().byte(),
            sign(motor)
        )
    });
    fill(program, &lines(motors), &rows::arduino(program.plan))
}

/// The sign of speeds and currents on the wire.
const fn sign(motor: &PlanMotor) -> i8 {
    if motor.mirrored { -1 } else { 1 }
}

/// One item per line.
fn lines(items: impl Iterator<Item = String>) -> String {
    let mut text = String::new();
    for item in items {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "    {item},");
    }
    text
}

/// Fills the placeholders of the sketch.
fn fill(program: &Program<'_>, motors: &str, rows: &str) -> String {
    let plan = program.plan;
    let limit = |limit: Option<f64>| limit.map_or("-1".to_owned(), |limit| format!("{limit:?}"));
    let period_ms = (plan.motors.len() * EXCHANGE_MS).max(PERIOD_MIN_MS);
    let parts = [
        ("@NAME@", plain(&program.sequence.name)),
        ("@PORT@", plain(program.port)),
        ("@WHAT@", plan.to_string()),
        ("@MOTOR_COUNT@", plan.motors.len().to_string()),
        ("@ROW_COUNT@", plan.program.len().to_string()),
        ("@PERIOD_MS@", period_ms.to_string()),
        ("@LIMIT_RPM@", limit(plan.limits.rpm)),
        ("@LIMIT_AMPS@", limit(plan.limits.amps)),
        ("@LIMIT_CELSIUS@", limit(plan.limits.celsius)),
    ];
    let put = |text: String, (name, part): &(&str, String)| text.replace(name, part);
    let text = parts.iter().fold(ARDUINO.to_owned(), put);
    // A list replaces a whole line, which is a comment.
    let list = |text: String, name: &str, list: &str| {
        let mut filled = String::new();
        for line in text.lines() {
            if line.trim_start_matches(['/', '#', ' ']) == name {
                filled.push_str(list);
            } else {
                filled.push_str(line);
                filled.push('\n');
            }
        }
        filled
    };
    list(list(text, "@MOTORS@", motors), "@ROWS@", rows)
}

/// A text without characters that any of the languages interprets.
pub(crate) fn plain(text: &str) -> String {
    let allowed =
        |character: char| character.is_ascii_alphanumeric() || " /._:+-".contains(character);
    let keep = |character| if allowed(character) { character } else { '_' };
    text.chars().map(keep).collect()
}
