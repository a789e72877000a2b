//! How far a wheel has rolled, from its replies.
//!
//! Between two replies the angle tells the way exactly, as long as the speeds tell the number of turns. Over a gap, and
//! while the angle does not follow the speed, the reported speeds tell it. Over a longer gap nothing is known, and
//! nothing is assumed.

use std::collections::VecDeque;

use motorlink_protocol::{CoarsePosition, Detail, Instant, Position, Rpm};

use super::angle_judge::{AngleJudge, Verdict};
use crate::number::{limited, modulo};

/// From so long a time between two replies on, the speeds bridge it: the angle no longer tells the turn where the
/// speed deviates by 100 rpm for 0.3 s.
const BRIDGED_OVER_US: u64 = 300_000;
/// The way by angle deviates from the way by speed by this at most: the same bound.
const DEVIATION_RPM_MAX: f64 = 100.0;
/// From so long a time on, what the wheel did is unknown. The history draws gaps of the same length.
pub(super) const GAP_OVER_US: u64 = 1_000_000;

/// How the way between two moments is known, from worst to best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Link {
    /// Not at all.
    Unknown,
    /// By the speeds: before and after a gap, or while the angle does not follow them.
    Bridged,
    /// By the replies.
    Known,
}

/// The resolution of the angle in a query reply, in degrees. It is cut off, not rounded.
const COARSE_STEP_DEG: f64 = 360.0 / 255.0;

/// The angle in a reply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Angle {
    /// Of a drive reply.
    Fine(Position),
    /// Of a query reply.
    Coarse(CoarsePosition),
    /// The reply has none that odometry can use.
    None,
}

impl From<Detail> for Angle {
    fn from(detail: Detail) -> Self {
        match detail {
            Detail::Drive { position } => Self::Fine(position),
            Detail::Query { position, .. } => Self::Coarse(position),
            // No source says whether the angle of an odometry reply grows at positive speed: its speed counts.
            Detail::Odometry { .. } | Detail::Temperature(_) | Detail::Undetermined(_) => {
                Self::None
            }
        }
    }
}

/// A reply, as odometry needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    pub(super) at_us: u64,
    /// The angle in degrees, which falls at positive speed, and its resolution.
    pub(super) angle: Option<(f64, f64)>,
    pub(super) rpm: f64,
    /// Whether it is the first of a connection.
    pub(super) is_cut_off: bool,
}

impl Report {
    /// A reply of this time. `is_cut_off` says whether it is the first of a connection.
    #[must_use]
    pub fn new(at: Instant, speed: Rpm, angle: Angle, is_cut_off: bool) -> Self {
        Self {
            at_us: at.as_micros(),
            angle: match angle {
                Angle::Fine(position) => Some((position.degrees().into(), 0.0)),
                Angle::Coarse(position) => Some((position.degrees().into(), COARSE_STEP_DEG)),
                Angle::None => None,
            },
            rpm: speed.rpm().into(),
            is_cut_off,
        }
    }
}

/// The way at a moment, in turns at positive speed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    at_us: u64,
    turns: f64,
    /// How the way from the knot before is known.
    link: Link,
}

/// The way of one wheel.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct WheelTrack {
    knots: VecDeque<Knot>,
    last: Option<Report>,
    turns: f64,
    /// From the way to the reported angle, in turns.
    offset: f64,
    judge: AngleJudge,
    /// By how much the way has exceeded the way by speed since the last verdict on the angle, in turns.
    by_angle: f64,
}

impl WheelTrack {
    /// When the last reply was read.
    pub(super) fn newest_us(&self) -> Option<u64> {
        self.last.map(|last| last.at_us)
    }

    /// Whether the angle was found not to follow the speed.
    pub(super) const fn angle_misfits(&self) -> bool {
        self.judge.misfits()
    }

    /// Takes a reply. One that is not newer than the last is skipped.
    pub(super) fn report(&mut self, report: Report) {
        let since_us = match self.last {
            Some(last) if report.at_us <= last.at_us => return,
            Some(last) => report.at_us - last.at_us,
            None => u64::MAX,
        };
        let link = match since_us {
            _ if report.is_cut_off => Link::Unknown,
            us if us <= BRIDGED_OVER_US => Link::Known,
            us if us <= GAP_OVER_US => Link::Bridged,
            _ => Link::Unknown,
        };
        let rpm_before = self.last.map_or(report.rpm, |last| last.rpm);
        let moved = turned(f64::midpoint(rpm_before, report.rpm), since_us);
        let expected = self.turns + moved;
        let angle = report
            .angle
            .map(|(degrees, step)| (-degrees / 360.0, step / 360.0));
        let mut link = link;
        match (link, angle) {
            (Link::Unknown, _) => {}
            (Link::Known, Some((angle, step))) => {
                let verdict = self.judge.angle(angle, step, moved, since_us);
                if self.judge.misfits() {
                    // Until the verdict the way followed the angle.
                    self.turns = expected - self.by_angle;
                    self.offset = angle - self.turns;
                    link = Link::Bridged;
                } else {
                    let off = modulo(angle - self.offset - expected + 0.5, 1.0) - 0.5;
                    let is_possible = off.abs() <= turned(DEVIATION_RPM_MAX, since_us) + step;
                    self.turns = if is_possible {
                        // A coarse angle only bounds the way.
                        let nearest = expected + off;
                        limited(expected, nearest - step, nearest + step)
                    } else {
                        expected
                    };
                    self.by_angle += self.turns - expected;
                }
                if verdict != Verdict::Open {
                    self.by_angle = 0.0;
                }
            }
            (Link::Known, None) | (Link::Bridged, _) => self.turns = expected,
        }
        if since_us > BRIDGED_OVER_US || report.is_cut_off {
            self.judge.gap();
            if let Some((angle, _)) = angle {
                self.offset = angle - self.turns;
            }
        }
        self.knots.push_back(Knot {
            at_us: report.at_us,
            turns: self.turns,
            link,
        });
        self.last = Some(report);
    }

    /// The turns within a period, and how they are known; `None` if any of it is unknown.
    pub(super) fn turns_between(&self, from_us: u64, to_us: u64) -> Option<(f64, Link)> {
        let mut turns = 0.0;
        let mut link = Link::Known;
        let mut covered_us = 0;
        for (before, after) in self.knots.iter().zip(self.knots.iter().skip(1)) {
            let (begin, end) = (from_us.max(before.at_us), to_us.min(after.at_us));
            if begin < end {
                covered_us += end - begin;
                link = link.min(after.link);
                let part = seconds(end - begin) / seconds(after.at_us - before.at_us);
                turns += part * (after.turns - before.turns);
            }
        }
        (covered_us == to_us.saturating_sub(from_us) && link > Link::Unknown)
            .then_some((turns, link))
    }

    /// Forgets what is older than this, so that the replies of a few ticks are kept.
    pub(super) fn forget_before(&mut self, us: u64) {
        while self.knots.get(1).is_some_and(|second| second.at_us <= us) {
            self.knots.pop_front();
        }
    }
}

/// Turns at a speed within a time.
fn turned(rpm: f64, us: u64) -> f64 {
    rpm / 60.0 * seconds(us)
}

#[allow(
    clippy::cast_precision_loss,
    reason = "a double has whole microseconds for 285 years"
)]
fn seconds(us: u64) -> f64 {
    us as f64 / 1e6
}

#[cfg(test)]
#[path = "wheel_track_tests.rs"]
mod tests;
