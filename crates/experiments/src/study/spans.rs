//! When each step of a run began and ended.

use motorlink_protocol::{Acceleration, Instant, MotorId};

use crate::{
    runner::{End as RunEnd, Record},
    sequence::{Action, End, Move, Quantity, Selection, Shape, Step},
};

/// A step that took this much longer than planned was paused.
const LATE_MAX_S: f64 = 0.25;

/// One pass of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    /// The instruction of the plan. For a sequence without repeats it is the number of the step.
    pub(super) step: usize,
    pub(super) from_s: f64,
    /// Its end, or the last sample if it still runs.
    pub(super) to_s: f64,
    /// Whether it still runs: its figures come later.
    pub(super) is_running: bool,
}

impl Span {
    /// Whether it lasted as long as planned: it was neither paused nor aborted.
    pub(super) fn lasted(self, seconds: f64) -> bool {
        (self.to_s - self.from_s - seconds).abs() <= LATE_MAX_S
    }

    /// Whether a step of this length took longer: it was paused.
    pub(super) fn was_paused(self, seconds: f64) -> bool {
        self.to_s - self.from_s > seconds + LATE_MAX_S
    }
}

/// The steps of a run in order of time.
pub(super) fn spans(record: &Record) -> Vec<Span> {
    let Some(began) = record.began_at() else {
        return Vec::new();
    };
    let seconds = |at: Instant| at.since(began).as_secs_f64();
    let end = match record.end() {
        Some(RunEnd::Finished { at } | RunEnd::Aborted { at, .. }) => Some(at),
        None => record.samples().last().map(|sample| sample.at),
    };
    let marks = record.marks();
    let ends = marks.iter().skip(1).map(|mark| mark.at).chain(end);
    let last = marks.len().saturating_sub(1);
    marks
        .iter()
        .zip(ends)
        .enumerate()
        .map(|(place, (mark, end))| Span {
            step: mark.step,
            from_s: seconds(mark.at),
            to_s: seconds(end),
            is_running: place == last && record.end().is_none(),
        })
        .collect()
}

/// A step of one motor.
pub(super) fn follow(motor: MotorId, quantity: Quantity, shape: Shape, end: End) -> Step {
    accelerated(motor, quantity, shape, end, Acceleration::DEFAULT)
}

/// A step of one motor with an acceleration.
pub(super) const fn accelerated(
    motor: MotorId,
    quantity: Quantity,
    shape: Shape,
    end: End,
    acceleration: Acceleration,
) -> Step {
    Step::Move(Move {
        selection: Selection::Motor(motor),
        action: Action::Follow {
            quantity,
            shape,
            acceleration,
        },
        end,
    })
}

/// A speed that is held.
pub(super) fn hold_rpm(motor: MotorId, rpm: f64, for_s: f64) -> Step {
    follow(
        motor,
        Quantity::Rpm,
        Shape::Step { to: rpm },
        End::After(for_s),
    )
}

/// A speed that is reached evenly.
pub(super) fn ramp_rpm(motor: MotorId, rpm: f64, for_s: f64) -> Step {
    follow(
        motor,
        Quantity::Rpm,
        Shape::Ramp { to: rpm },
        End::After(for_s),
    )
}
