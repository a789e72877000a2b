//! Whether the angle of a wheel follows its speed.
//!
//! A motor was seen to report one angle for ever (`DDTRobot/motor-driver-examples#1`). The way by such an angle is zero;
//! by an angle of noise it is any.

use crate::number::{limited, modulo};

/// Angle and speed are compared after this time, or this way if it is shorter. Between two replies at 200 Hz a slow
/// wheel moves less than the noise of its angle.
const COMPARED_AFTER_US: u64 = 100_000;
const COMPARED_AFTER_TURNS: f64 = 0.1;
/// Over a longer way the angle may be off by half a turn only, so no more of it counts.
const COUNTED_TURNS_MAX: f64 = 0.2;
/// Noise of an angle, in turns: a third of a degree.
const NOISE_TURNS: f64 = 0.001;
/// The angle may differ by this part of the way: a speed of 1 rpm is rounded by half of it, and a reported speed lags.
/// An angle that stays differs by all of it.
const DIFFERS_MAX: f64 = 0.7;
/// And by so many turns: the lag of a speed that changes by 200 rpm.
const LAG_TURNS: f64 = 0.1;
/// A verdict is due after this way.
const JUDGED_TURNS: f64 = 1.0;

/// What a comparison has found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Nothing yet.
    Open,
    /// The angle has followed for a turn.
    Follows,
    /// The angle does not follow.
    Misfits,
}

/// The comparison of the angle of one wheel with its speed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct AngleJudge {
    /// The angle at which the present comparison began, and its resolution, in turns.
    from: Option<(f64, f64)>,
    /// The way by speed and the time since then.
    way: f64,
    us: u64,
    /// The differences and the ways of the comparisons since the last verdict.
    differed: f64,
    rolled: f64,
    misfits: bool,
}

impl AngleJudge {
    /// Takes an angle with its resolution, and the way by speed since the last one, in turns.
    pub(super) fn angle(&mut self, angle: f64, step: f64, moved: f64, us: u64) -> Verdict {
        self.way += moved;
        self.us = self.us.saturating_add(us);
        let Some((from, from_step)) = self.from else {
            self.restart(angle, step);
            return Verdict::Open;
        };
        if self.us < COMPARED_AFTER_US && self.way.abs() < COMPARED_AFTER_TURNS {
            return Verdict::Open;
        }
        let off = modulo(angle - from - self.way + 0.5, 1.0) - 0.5;
        self.differed += (off.abs() - step.max(from_step) - NOISE_TURNS).max(0.0);
        self.rolled += limited(self.way.abs(), 0.0, COUNTED_TURNS_MAX);
        self.restart(angle, step);
        let verdict = if self.differed > DIFFERS_MAX * self.rolled + LAG_TURNS {
            Verdict::Misfits
        } else if self.rolled >= JUDGED_TURNS {
            Verdict::Follows
        } else {
            return Verdict::Open;
        };
        (self.differed, self.rolled) = (0.0, 0.0);
        self.misfits = verdict == Verdict::Misfits;
        verdict
    }

    /// Over a gap nothing is compared.
    pub(super) const fn gap(&mut self) {
        self.from = None;
    }

    /// Whether the angle does not follow the speed.
    pub(super) const fn misfits(&self) -> bool {
        self.misfits
    }

    const fn restart(&mut self, angle: f64, step: f64) {
        (self.from, self.way, self.us) = (Some((angle, step)), 0.0, 0);
    }
}
