//! Estimates the present angle from reports that may be old or coarse.
//!
//! There are two layers. The *track* is the reported motion: the last angle, and the speed at which it continues. The
//! *lag* is the deviation of the drawn wheel from the track. A report moves the track at once and the lag takes up
//! the difference, so the drawn wheel never jumps. The lag then decays from frame to frame, slower than the wheel
//! turns, so the drawn wheel never turns backwards either.
//!
//! Time is an argument: milliseconds on the page's clock. The time of a report is the time of its measurement.

use motorlink_messages::bus::FRESH_FOR;

use crate::ui::mathematics::{exp, limited, modulo};

/// The resolution of a reported angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleQuality {
    /// 0.01 degrees, in replies to drive frames.
    Fine,
    /// 1.4 degrees, in replies to feedback queries.
    Coarse,
}

/// A reported angle in degrees. It falls at positive speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportedAngle {
    /// 0 to 360.
    pub degrees: f64,
    /// Its resolution.
    pub quality: AngleQuality,
}

/// How the drawn wheel reaches the angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// It turns there.
    Turn,
    /// It jumps there: the way was not visible.
    Jump,
    /// It stays as drawn: the angle is unknown.
    Stay,
}

/// The present angle and rate of the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// How the drawn wheel reaches it.
    pub way: Way,
    /// The reported angle extrapolated to now, in degrees and unwrapped: it can be any number. As a clockwise
    /// rotation it turns the drawn wheel in the right direction.
    pub angle_deg: f64,
    /// Rate of the angle; 0 if unknown.
    pub rate_deg_per_s: f64,
    /// Until when the last report may be extrapolated.
    pub known_until_ms: f64,
}

/// The drawn state of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub heading: Heading,
    /// Speed, smoothed over a few frames; positive is counter-clockwise.
    pub speed_rpm: f64,
    /// Whether the last report is recent enough to extrapolate from.
    pub fresh: bool,
    /// Whether the next frame looks the same without a new report.
    pub settled: bool,
}

/// Maximal age of a report to extrapolate from, in milliseconds.
#[allow(
    clippy::cast_precision_loss,
    reason = "half a second in milliseconds is exact"
)]
pub const FRESH_MS: f64 = FRESH_FOR.as_millis() as f64;

/// A coarse angle is truncated, not rounded, and can be off by one step of 360/255 degrees.
const COARSE_STEP_DEG: f64 = 360.0 / 255.0;
/// Time constant of the lag: it falls to a third in about six frames, which is too smooth to be noticed.
const LAG_DECAY_MS: f64 = 100.0;
/// Maximal rate at which the lag decays against the rotation, as a part of the wheel's own rate, so that the drawn
/// wheel only slows down.
const LAG_SHARE: f64 = 0.5;
/// Rate at which the lag may decay along the rotation, and in both directions at standstill.
const EASE_DEG_PER_S: f64 = 60.0;
/// With a larger lag the wheel jumps: it was turned while nobody saw it.
const SNAP_DEG: f64 = 90.0;
/// After a longer gap between frames the motion need not be smooth: a hidden page draws no frames.
const UNSEEN_MS: f64 = 250.0;
/// Time constant of the drawn speed: it smooths steps of 1 rpm.
const SPEED_SMOOTHING_MS: f64 = 70.0;
/// A smaller difference is invisible: a fiftieth of a millimetre at the tread.
const SETTLED_DEG: f64 = 0.02;
/// The same for speed: a hundredth of a degree on the ring.
const SETTLED_RPM: f64 = 0.02;
/// A report that is this much older than the last one is from another clock: the estimator restarts.
const OTHER_CLOCK_MS: f64 = 1_000.0;

/// The reported motion.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Track {
    at_ms: f64,
    angle_deg: f64,
    rate_deg_per_s: f64,
}

impl Track {
    /// The angle at a time, extrapolated from the last report as long as it is recent.
    fn angle_at(&self, ms: f64) -> f64 {
        let age_ms = (ms - self.at_ms).min(FRESH_MS);
        self.angle_deg + self.rate_deg_per_s * age_ms / 1_000.0
    }
}

/// Estimates the drawn wheel's angle and speed, frame by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimator {
    track: Option<Track>,
    lag_deg: f64,
    /// The last frame and its drawn state.
    drawn_ms: Option<f64>,
    drawn_deg: f64,
    speed_rpm: f64,
    /// Whether the track has started since the last frame.
    begun: bool,
}

impl Estimator {
    /// Takes a report. An older one than the last, or one with a value that is not a number, is ignored.
    pub fn report(&mut self, at_ms: f64, angle: Option<ReportedAngle>, speed_rpm: f64) {
        let angle = angle.filter(|angle| angle.degrees.is_finite());
        if !at_ms.is_finite() || !speed_rpm.is_finite() {
            return;
        }
        let rate_deg_per_s = speed_rpm * -6.0;
        let before = match self.track {
            Some(track) if at_ms < track.at_ms - OTHER_CLOCK_MS => None,
            Some(track) if at_ms < track.at_ms => return,
            track => track,
        };
        let angle_deg = match (before, angle) {
            (Some(track), Some(angle)) => corrected(travelled(track, at_ms, rate_deg_per_s), angle),
            (Some(track), None) => travelled(track, at_ms, rate_deg_per_s),
            // Without a track: the turn nearest to the drawn angle.
            (None, Some(angle)) => nearest(self.drawn_deg, angle.degrees),
            (None, None) => return,
        };
        let track = Track {
            at_ms,
            angle_deg,
            rate_deg_per_s,
        };
        self.begun |= before.is_none();
        self.take_up(before, track);
        self.track = Some(track);
    }

    /// Adds the difference between the new and the old track in the last frame to the lag.
    fn take_up(&mut self, before: Option<Track>, after: Track) {
        self.lag_deg = match (before, self.drawn_ms) {
            (Some(before), Some(drawn_ms)) if after.at_ms - drawn_ms < UNSEEN_MS => {
                self.lag_deg + before.angle_at(drawn_ms) - after.angle_at(drawn_ms)
            }
            _ => 0.0,
        };
        if self.lag_deg.abs() > SNAP_DEG {
            self.lag_deg = 0.0;
        }
    }

    /// The state to draw now.
    pub fn frame(&mut self, now_ms: f64) -> Pose {
        let elapsed_ms = self.drawn_ms.map_or(0.0, |last| (now_ms - last).max(0.0));
        self.drawn_ms = Some(now_ms);
        let Some(track) = self.track else {
            self.speed_rpm = 0.0;
            return Pose {
                heading: Heading {
                    way: Way::Stay,
                    angle_deg: self.drawn_deg,
                    rate_deg_per_s: 0.0,
                    known_until_ms: now_ms,
                },
                speed_rpm: 0.0,
                fresh: false,
                settled: true,
            };
        };
        let fresh = now_ms - track.at_ms <= FRESH_MS;
        let reported_rpm = track.rate_deg_per_s / -6.0;
        if fresh {
            self.melt(track.rate_deg_per_s, elapsed_ms);
            let off = (self.speed_rpm - reported_rpm) * exp(-elapsed_ms / SPEED_SMOOTHING_MS);
            let seen = off.abs() > SETTLED_RPM && elapsed_ms < UNSEEN_MS;
            self.speed_rpm = reported_rpm + if seen { off } else { 0.0 };
        }
        self.drawn_deg = track.angle_at(now_ms) + self.lag_deg;
        let standing = track.rate_deg_per_s.abs() < f64::EPSILON
            && self.lag_deg.abs() < SETTLED_DEG
            && (self.speed_rpm - reported_rpm).abs() < SETTLED_RPM;
        Pose {
            heading: Heading {
                way: if std::mem::take(&mut self.begun) || elapsed_ms >= UNSEEN_MS {
                    Way::Jump
                } else {
                    Way::Turn
                },
                angle_deg: self.drawn_deg,
                rate_deg_per_s: if fresh { track.rate_deg_per_s } else { 0.0 },
                known_until_ms: track.at_ms + FRESH_MS,
            },
            speed_rpm: self.speed_rpm,
            fresh,
            settled: !fresh || standing,
        }
    }

    fn melt(&mut self, rate_deg_per_s: f64, elapsed_ms: f64) {
        let wanted = self.lag_deg * (exp(-elapsed_ms / LAG_DECAY_MS) - 1.0);
        let standing = rate_deg_per_s.abs() < f64::EPSILON;
        let along = wanted * rate_deg_per_s >= 0.0;
        let own = LAG_SHARE * rate_deg_per_s.abs();
        let most_deg_per_s = if standing || along {
            own.max(EASE_DEG_PER_S)
        } else {
            own
        };
        let most = most_deg_per_s * elapsed_ms / 1_000.0;
        self.lag_deg += limited(wanted, -most, most);
    }

    /// The next frame is drawn as reported, without a transition.
    pub fn jump(&mut self) {
        self.drawn_ms = Some(f64::NEG_INFINITY);
    }

    /// Forgets the reports. The wheel stays as it was drawn.
    pub fn clear(&mut self) {
        *self = Self {
            drawn_ms: self.drawn_ms,
            // Within one turn: over days a growing angle would lose digits.
            drawn_deg: modulo(self.drawn_deg, 360.0),
            ..Self::default()
        };
    }
}

/// The angle that the track travels until a later report, by the mean of the speeds at both ends. The error is below
/// half a turn for gaps of 0.3 s in which the speed deviates by 100 rpm, which selects the right turn.
fn travelled(track: Track, at_ms: f64, rate_deg_per_s: f64) -> f64 {
    let mean = f64::midpoint(track.rate_deg_per_s, rate_deg_per_s);
    track.angle_deg + mean * (at_ms - track.at_ms) / 1_000.0
}

/// The reported angle, unwrapped to the turn nearest to the expected angle.
fn nearest(expected_deg: f64, reported_deg: f64) -> f64 {
    let off = modulo(reported_deg - expected_deg + 180.0, 360.0) - 180.0;
    expected_deg + off
}

/// Corrects the expected angle. A fine angle replaces it. A coarse one only bounds the angle to one step, so it moves
/// the track no further than to that bound.
fn corrected(expected_deg: f64, angle: ReportedAngle) -> f64 {
    let reported = nearest(expected_deg, angle.degrees);
    match angle.quality {
        AngleQuality::Fine => reported,
        AngleQuality::Coarse => limited(
            expected_deg,
            reported - COARSE_STEP_DEG,
            reported + COARSE_STEP_DEG,
        ),
    }
}

#[cfg(test)]
#[path = "motion_tests.rs"]
mod tests;
