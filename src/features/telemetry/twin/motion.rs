//! From reports, some of them old and some of them coarse, to the angle that is drawn now.
//!
//! Two layers. The *track* is what the reports say: the last angle, and the speed at which it goes
//! on. The *lag* is how far the drawn wheel is off the track. A report moves the track at once and
//! the lag takes up the difference, so the drawn wheel never jumps; from frame to frame the lag then
//! melts away, slower than the wheel turns, so the drawn wheel never runs backwards either.
//!
//! Time is an argument: milliseconds on the page's clock, for reports that of their measurement.

use motorlink_messages::bus::FRESH_FOR;

use crate::ui::mathematics::exp;

/// How exactly a reply reports its angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleQuality {
    /// To 0.01 degrees, as replies to drive frames do.
    Fine,
    /// In steps of 1.4 degrees, as replies to feedback queries do.
    Coarse,
}

/// A reported angle in degrees. It falls at positive speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportedAngle {
    /// 0 to 360.
    pub degrees: f64,
    /// How far it can be trusted.
    pub quality: AngleQuality,
}

/// How the drawn wheel gets to where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Turning, from where it is drawn.
    On,
    /// Put there: nobody saw the way.
    There,
    /// It stays where it is drawn: nothing is known.
    Nowhere,
}

/// Where the wheel is and how it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// How it gets there.
    pub way: Way,
    /// The reported angle as it is now, in degrees and unwrapped: it may be any number. As a
    /// clockwise rotation it turns the drawn wheel the right way.
    pub angle_deg: f64,
    /// How fast that grows; 0 where nothing is known.
    pub rate_deg_per_s: f64,
    /// How long the last report can be gone by.
    pub known_until_ms: f64,
}

/// What is drawn in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub heading: Heading,
    /// Speed, smoothed over a few frames; positive is counter-clockwise.
    pub speed_rpm: f64,
    /// Whether the last report is young enough to go by.
    pub fresh: bool,
    /// Whether the next frame would look the same if no report came.
    pub settled: bool,
}

/// Reports older than this are not extrapolated from, in milliseconds.
#[allow(
    clippy::cast_precision_loss,
    reason = "half a second in milliseconds is exact"
)]
pub const FRESH_MS: f64 = FRESH_FOR.as_millis() as f64;

/// A coarse angle is cut off, not rounded, and may be off by one step of 360/255 degrees.
const COARSE_STEP_DEG: f64 = 360.0 / 255.0;
/// The lag falls to a third in this time: half a dozen frames, too soft to be seen.
const LAG_MELTS_MS: f64 = 100.0;
/// Against the turning the lag melts at no more than this part of the wheel's own rate, so that the
/// drawn wheel only slows down.
const LAG_SHARE: f64 = 0.5;
/// Along the turning, and on a standing wheel either way, it may melt at this rate.
const EASE_DEG_PER_S: f64 = 60.0;
/// A lag of more than a quarter turn is a wheel that was turned unseen: it is not wound back.
const SNAP_DEG: f64 = 90.0;
/// Nobody has seen the wheel between frames this far apart: no need to be smooth. (A hidden page
/// draws no frames.)
const UNSEEN_MS: f64 = 250.0;
/// Speed as drawn follows speed as reported to a third in this time: steps of 1 rpm become smooth.
const SPEED_FOLLOWS_MS: f64 = 70.0;
/// Below this the eye sees no difference: a fiftieth of a millimetre at the tread.
const SETTLED_DEG: f64 = 0.02;
/// The same for speed: a hundredth of a degree on the ring.
const SETTLED_RPM: f64 = 0.02;
/// A report this much older than the last is of another clock, not late: begin anew.
const OTHER_CLOCK_MS: f64 = 1_000.0;

/// What the reports say.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Track {
    at_ms: f64,
    angle_deg: f64,
    rate_deg_per_s: f64,
}

impl Track {
    /// The angle at a time, as far as these reports reach.
    fn angle_at(&self, ms: f64) -> f64 {
        let age_ms = (ms - self.at_ms).min(FRESH_MS);
        self.angle_deg + self.rate_deg_per_s * age_ms / 1_000.0
    }
}

/// The drawn wheel's angle and speed, frame by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimator {
    track: Option<Track>,
    lag_deg: f64,
    /// The last frame, and what was drawn in it.
    drawn_ms: Option<f64>,
    drawn_deg: f64,
    speed_rpm: f64,
    /// The angle from which turns are counted.
    origin_deg: Option<f64>,
    /// Whether the track was begun since the last frame.
    begun: bool,
}

impl Estimator {
    /// Takes a report in. One that is older than the last, or not a number, changes nothing.
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
            // Nothing to go on from: the turn nearest to what is drawn.
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
        self.origin_deg.get_or_insert(angle_deg);
    }

    /// Lets the lag take up what the new track differs from the old in the frame last seen.
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

    /// What to draw now.
    pub fn frame(&mut self, now_ms: f64) -> Pose {
        let elapsed_ms = self.drawn_ms.map_or(0.0, |last| (now_ms - last).max(0.0));
        self.drawn_ms = Some(now_ms);
        let Some(track) = self.track else {
            self.speed_rpm = 0.0;
            return Pose {
                heading: Heading {
                    way: Way::Nowhere,
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
            let off = (self.speed_rpm - reported_rpm) * exp(-elapsed_ms / SPEED_FOLLOWS_MS);
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
                    Way::There
                } else {
                    Way::On
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
        let wanted = self.lag_deg * (exp(-elapsed_ms / LAG_MELTS_MS) - 1.0);
        let standing = rate_deg_per_s.abs() < f64::EPSILON;
        let along = wanted * rate_deg_per_s >= 0.0;
        let own = LAG_SHARE * rate_deg_per_s.abs();
        let most_deg_per_s = if standing || along {
            own.max(EASE_DEG_PER_S)
        } else {
            own
        };
        let most = most_deg_per_s * elapsed_ms / 1_000.0;
        self.lag_deg += wanted.clamp(-most, most);
    }

    /// Turns since the first report, counted in the direction of positive speed.
    #[must_use]
    pub fn turns(&self) -> f64 {
        let origin = self.origin_deg.unwrap_or(self.drawn_deg);
        (origin - self.drawn_deg) / 360.0
    }

    /// Forgets the reports and the count of turns. The wheel stays as it was drawn.
    pub fn clear(&mut self) {
        *self = Self {
            drawn_ms: self.drawn_ms,
            // Within one turn, or it would lose digits over days.
            drawn_deg: self.drawn_deg.rem_euclid(360.0),
            ..Self::default()
        };
    }
}

/// Where the track has come to by a later report, by the mean of the speeds at both ends. That is
/// within half a turn for gaps in which the speed goes astray by 100 rpm for 0.3 s, and so picks the
/// right turn.
fn travelled(track: Track, at_ms: f64, rate_deg_per_s: f64) -> f64 {
    let mean = f64::midpoint(track.rate_deg_per_s, rate_deg_per_s);
    track.angle_deg + mean * (at_ms - track.at_ms) / 1_000.0
}

/// The reported angle, in the turn that is nearest to where it was expected.
fn nearest(expected_deg: f64, reported_deg: f64) -> f64 {
    let off = (reported_deg - expected_deg + 180.0).rem_euclid(360.0) - 180.0;
    expected_deg + off
}

/// A fine angle is believed. A coarse one only says that the wheel is within a step of it, and moves
/// the track no further than to there.
fn corrected(expected_deg: f64, angle: ReportedAngle) -> f64 {
    let reported = nearest(expected_deg, angle.degrees);
    match angle.quality {
        AngleQuality::Fine => reported,
        AngleQuality::Coarse => {
            expected_deg.clamp(reported - COARSE_STEP_DEG, reported + COARSE_STEP_DEG)
        }
    }
}

#[cfg(test)]
#[path = "motion_tests.rs"]
mod tests;
