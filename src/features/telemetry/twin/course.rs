//! The planned motion of the drawn wheel. The browser animates it between two updates, so that the page does not have
//! to draw sixty times a second.
//!
//! A course is an angle that changes linearly over time until an end, so that the wheel stops if the page hangs. It
//! is replaced only if it deviates too much from the reports.
//!
//! Times are milliseconds on the page's clock.

use crate::{
    features::telemetry::twin::motion::{Heading, Way},
    ui::frame_rate::frame_rate,
};

/// A deviation is corrected within this time.
const CORRECTION_MS: f64 = 100.0;
/// A smaller deviation is not corrected: half a millimetre at the tread of a wheel of 102 mm.
const OFF_MAX_DEG: f64 = 1.0;
/// The same for a wheel at standstill: a fiftieth of a millimetre at the tread.
const STANDSTILL_OFF_MAX_DEG: f64 = 0.02;
/// A smaller deviation of the rate is not corrected: about one rpm.
const RATE_OFF_MAX_DEG_PER_S: f64 = 6.5;
/// A course is renewed this many updates before its end.
const RENEWED_BEFORE_UPDATES: f64 = 3.0;
/// With a larger deviation the wheel jumps instead of turning to the angle.
const SNAP_DEG: f64 = 90.0;

/// A rotation from an angle at a constant rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// Start.
    pub from_ms: f64,
    /// End. The wheel then stays at the last angle.
    pub until_ms: f64,
    /// The angle at the start, in degrees and unwrapped.
    pub angle_deg: f64,
    /// Rate of the angle; the angle grows if it is positive.
    pub rate_deg_per_s: f64,
}

impl Course {
    /// The angle at this time.
    #[must_use]
    pub fn angle_at(&self, ms: f64) -> f64 {
        let ran_ms = ms.min(self.until_ms) - self.from_ms;
        self.angle_deg + self.rate_deg_per_s * ran_ms / 1_000.0
    }

    /// The rest of the same course, from now on.
    #[must_use]
    pub fn from(&self, now_ms: f64) -> Self {
        Self {
            from_ms: now_ms,
            angle_deg: self.angle_at(now_ms),
            ..*self
        }
    }

    /// The course in steps of `step_ms` that begin at multiples of `step_ms`, and the number of steps. It starts up
    /// to one step earlier and ends up to one step later, with the same angles in between.
    #[must_use]
    pub fn in_steps(&self, step_ms: f64) -> (Self, f64) {
        let from_ms = (self.from_ms / step_ms).floor() * step_ms;
        let steps = ((self.until_ms - from_ms) / step_ms).ceil().max(1.0);
        let before_ms = self.from_ms - from_ms;
        let course = Self {
            from_ms,
            until_ms: from_ms + steps * step_ms,
            angle_deg: self.angle_deg - self.rate_deg_per_s * before_ms / 1_000.0,
            ..*self
        };
        (course, steps)
    }

    /// A wheel at standstill.
    const fn standing(angle_deg: f64, now_ms: f64) -> Self {
        Self {
            from_ms: now_ms,
            until_ms: now_ms,
            angle_deg,
            rate_deg_per_s: 0.0,
        }
    }

    /// The course from now on, if it has to change.
    #[must_use]
    pub fn next(course: Option<Self>, heading: Heading, now_ms: f64) -> Option<Self> {
        match (course, heading.way) {
            (None, _) | (_, Way::Jump) => Some(Self::begun(heading, now_ms)),
            (Some(course), Way::Turn) => course.corrected(heading, now_ms),
            (Some(course), Way::Stay) => {
                let runs = now_ms < course.until_ms;
                runs.then(|| Self::standing(course.angle_at(now_ms), now_ms))
            }
        }
    }

    /// The course from now on, if this one deviates too much from the heading.
    fn corrected(&self, heading: Heading, now_ms: f64) -> Option<Self> {
        let drawn_deg = self.angle_at(now_ms);
        let off_deg = heading.angle_deg - drawn_deg;
        let stands = heading.rate_deg_per_s.abs() < f64::EPSILON;
        if off_deg.abs() > SNAP_DEG {
            return Some(Self::begun(heading, now_ms));
        }
        let ended = now_ms >= self.until_ms;
        if stands && ended && off_deg.abs() <= STANDSTILL_OFF_MAX_DEG {
            return None;
        }
        let rate_off = (self.rate_deg_per_s - heading.rate_deg_per_s).abs();
        let lasts = self.until_ms - now_ms >= RENEWED_BEFORE_UPDATES * frame_rate().step_ms();
        let near = off_deg.abs() <= OFF_MAX_DEG && rate_off <= RATE_OFF_MAX_DEG_PER_S;
        if !stands && near && lasts {
            return None;
        }
        let correction = off_deg * 1_000.0 / CORRECTION_MS;
        let rate_deg_per_s = heading.rate_deg_per_s + correction;
        let backwards = rate_deg_per_s * heading.rate_deg_per_s < 0.0;
        Some(Self {
            from_ms: now_ms,
            until_ms: if stands {
                now_ms + CORRECTION_MS
            } else {
                heading.known_until_ms.max(now_ms)
            },
            angle_deg: drawn_deg,
            // A turning wheel is slowed down, never turned back.
            rate_deg_per_s: if backwards { 0.0 } else { rate_deg_per_s },
        })
    }

    /// The first course.
    fn begun(heading: Heading, now_ms: f64) -> Self {
        Self {
            until_ms: heading.known_until_ms.max(now_ms),
            rate_deg_per_s: heading.rate_deg_per_s,
            ..Self::standing(heading.angle_deg, now_ms)
        }
    }
}

#[cfg(test)]
#[path = "course_tests.rs"]
mod tests;
