//! The instructions of a plan as the table of the sketch.

use crate::{
    plan::{Op, Plan, PlannedMove},
    sequence::{Action, Condition, End, Shape},
};

/// An instruction with a value in every column.
struct Row {
    /// 0 is a move, 1 begins a loop, 2 ends one.
    kind: u8,
    motors: Vec<usize>,
    /// 0 step, 1 ramp, 2 sine, 3 triangle, 4 chirp, 5 brake.
    shape: u8,
    value: f64,
    amplitude: f64,
    hz: f64,
    to_hz: f64,
    acceleration: u8,
    seconds: f64,
    /// 0 none, 1 rpm above, 2 rpm below, 3 degrees near, 4 celsius above, 5 celsius below.
    condition: u8,
    bound: f64,
    tolerance: f64,
    /// Passes of a loop, or the row of its beginning.
    number: usize,
}

impl Row {
    fn of(op: &Op) -> Self {
        match op {
            Op::Move(step) => Self::of_move(step),
            Op::Loop { passes } => Self {
                kind: 1,
                number: usize::try_from(*passes).unwrap_or(usize::MAX),
                ..Self::empty()
            },
            Op::Again { first, until } => Self {
                kind: 2,
                number: *first,
                ..Self::empty().until(*until)
            },
        }
    }

    const fn empty() -> Self {
        Self {
            kind: 0,
            motors: Vec::new(),
            shape: 0,
            value: 0.0,
            amplitude: 0.0,
            hz: 0.0,
            to_hz: 0.0,
            acceleration: 0,
            seconds: 0.0,
            condition: 0,
            bound: 0.0,
            tolerance: 0.0,
            number: 0,
        }
    }

    fn of_move(step: &PlannedMove) -> Self {
        let until = match step.end {
            End::After(_) => None,
            End::Until { condition, .. } => Some(condition),
        };
        let row = Self {
            motors: step.motors.clone(),
            seconds: step.seconds(),
            ..Self::empty().until(until)
        };
        let Action::Follow {
            shape,
            acceleration,
            ..
        } = step.action
        else {
            return Self { shape: 5, ..row };
        };
        let row = Self {
            acceleration: acceleration.byte(),
            ..row
        };
        let (shape, value, wave, to_hz) = match shape {
            Shape::Step { to } => (0, to, None, 0.0),
            Shape::Ramp { to } => (1, to, None, 0.0),
            Shape::Sine(wave) => (2, wave.centre, Some(wave), 0.0),
            Shape::Triangle(wave) => (3, wave.centre, Some(wave), 0.0),
            Shape::Chirp { wave, to_hz } => (4, wave.centre, Some(wave), to_hz),
        };
        Self {
            shape,
            value,
            amplitude: wave.map_or(0.0, |wave| wave.amplitude),
            hz: wave.map_or(0.0, |wave| wave.hz),
            to_hz,
            ..row
        }
    }

    fn until(self, condition: Option<Condition>) -> Self {
        let (condition, bound, tolerance) = match condition {
            None => (0, 0.0, 0.0),
            Some(Condition::RpmAbove(rpm)) => (1, rpm, 0.0),
            Some(Condition::RpmBelow(rpm)) => (2, rpm, 0.0),
            Some(Condition::DegreesNear { degrees, tolerance }) => (3, degrees, tolerance),
            Some(Condition::CelsiusAbove(celsius)) => (4, celsius, 0.0),
            Some(Condition::CelsiusBelow(celsius)) => (5, celsius, 0.0),
        };
        Self {
            condition,
            bound,
            tolerance,
            ..self
        }
    }

    /// The columns in the order of the sketch. Motors are one bit each.
    fn columns(&self) -> String {
        let motors: u32 = self.motors.iter().map(|motor| 1 << motor).sum();
        format!(
            "{}, {motors}, {}, {:?}, {:?}, {:?}, {:?}, {}, {:?}, {}, {:?}, {:?}, {}",
            self.kind,
            self.shape,
            self.value,
            self.amplitude,
            self.hz,
            self.to_hz,
            self.acceleration,
            self.seconds,
            self.condition,
            self.bound,
            self.tolerance,
            self.number
        )
    }
}

pub(super) fn arduino(plan: &Plan) -> String {
    let rows = plan.program.iter().map(Row::of);
    super::lines(rows.map(|row| format!("{{{}}}", row.columns())))
}
