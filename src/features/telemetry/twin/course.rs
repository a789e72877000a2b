//! The way that the drawn wheel is sent on, so that the browser turns it between two looks at the reports
//! and the page need not draw sixty times a second.
//!
//! A course is a straight line of angle over time, and an end: a page that hangs shows no wheel that turns
//! on and on. It is left as it is while it is near enough to what the reports say.
//!
//! Times are milliseconds on the page's clock.

use crate::{
    features::telemetry::twin::motion::{Heading, Way},
    ui::frame_rate::frame_rate,
};

/// What a course is off is made good within this.
const MADE_GOOD_MS: f64 = 100.0;
/// Nearer than this it is left alone: half a millimetre at the tread of a wheel as wide as a hand.
const OFF_MAX_DEG: f64 = 1.0;
/// So is a wheel that stands: a fiftieth of a millimetre there.
const STANDS_OFF_MAX_DEG: f64 = 0.02;
/// And a course whose speed is within one revolution a minute.
const RATE_OFF_MAX_DEG_PER_S: f64 = 6.5;
/// It is renewed so many looks before it ends.
const RENEWED_BEFORE_LOOKS: f64 = 3.0;
/// Further off it is another place, to which the wheel is not wound.
const SNAP_DEG: f64 = 90.0;

/// From an angle, at a rate, until.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// When it begins.
    pub from_ms: f64,
    /// When it ends. The wheel then stays where it has come to.
    pub until_ms: f64,
    /// The angle at its beginning, in degrees and unwrapped.
    pub angle_deg: f64,
    /// How fast the angle grows.
    pub rate_deg_per_s: f64,
}

impl Course {
    /// The angle at this time.
    #[must_use]
    pub fn angle_at(&self, ms: f64) -> f64 {
        let ran_ms = ms.min(self.until_ms) - self.from_ms;
        self.angle_deg + self.rate_deg_per_s * ran_ms / 1_000.0
    }

    /// The same course from now on.
    #[must_use]
    pub fn from(&self, now_ms: f64) -> Self {
        Self {
            from_ms: now_ms,
            angle_deg: self.angle_at(now_ms),
            ..*self
        }
    }

    /// The course in steps of so many milliseconds that begin at multiples of that length, and how many steps. It
    /// begins up to a step earlier and ends up to a step later, on the same line.
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

    /// A wheel that stands there.
    const fn standing(angle_deg: f64, now_ms: f64) -> Self {
        Self {
            from_ms: now_ms,
            until_ms: now_ms,
            angle_deg,
            rate_deg_per_s: 0.0,
        }
    }

    /// The course from now on, where there is to be another.
    #[must_use]
    pub fn next(course: Option<Self>, heading: Heading, now_ms: f64) -> Option<Self> {
        match (course, heading.way) {
            (None, _) | (_, Way::There) => Some(Self::begun(heading, now_ms)),
            (Some(course), Way::On) => course.corrected(heading, now_ms),
            (Some(course), Way::Nowhere) => {
                let runs = now_ms < course.until_ms;
                runs.then(|| Self::standing(course.angle_at(now_ms), now_ms))
            }
        }
    }

    /// The course from now on, where this one is not near enough to the heading.
    fn corrected(&self, heading: Heading, now_ms: f64) -> Option<Self> {
        let drawn_deg = self.angle_at(now_ms);
        let off_deg = heading.angle_deg - drawn_deg;
        let stands = heading.rate_deg_per_s.abs() < f64::EPSILON;
        if off_deg.abs() > SNAP_DEG {
            return Some(Self::begun(heading, now_ms));
        }
        let ended = now_ms >= self.until_ms;
        if stands && ended && off_deg.abs() <= STANDS_OFF_MAX_DEG {
            return None;
        }
        let rate_off = (self.rate_deg_per_s - heading.rate_deg_per_s).abs();
        let lasts = self.until_ms - now_ms >= RENEWED_BEFORE_LOOKS * frame_rate().step_ms();
        let near = off_deg.abs() <= OFF_MAX_DEG && rate_off <= RATE_OFF_MAX_DEG_PER_S;
        if !stands && near && lasts {
            return None;
        }
        let made_good = off_deg * 1_000.0 / MADE_GOOD_MS;
        let rate_deg_per_s = heading.rate_deg_per_s + made_good;
        let backwards = rate_deg_per_s * heading.rate_deg_per_s < 0.0;
        Some(Self {
            from_ms: now_ms,
            until_ms: if stands {
                now_ms + MADE_GOOD_MS
            } else {
                heading.known_until_ms.max(now_ms)
            },
            angle_deg: drawn_deg,
            // A wheel that turns is slowed down, not turned back.
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
