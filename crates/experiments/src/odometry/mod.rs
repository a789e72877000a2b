//! The motion of the vehicle from the ways of its wheels: a differential drive, whose wheels roll and do not slip.

//!
//! | file | idea |
//! |---|---|
//! | `angle_judge` | whether the angle of a wheel follows its speed |
//! | `wheel_track` | how far a wheel has rolled, from its replies |

mod angle_judge;
mod wheel_track;

use motorlink_protocol::Instant;

use crate::{
    number::sin_cos,
    vehicle::{Geometry, Motion, Vehicle, Wheel},
};
use wheel_track::{GAP_OVER_US, WheelTrack};

pub use wheel_track::{Angle, Link, Report};

/// The vehicle moves on an exact arc within each tick: one period of a motor at 50 Hz.
const TICK_US: u64 = 20_000;
const TICKS_PER_S: f64 = 50.0;

/// Where the vehicle is, from where it began, which was straight ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// To the right, in mm.
    pub x: f64,
    /// Ahead, in mm.
    pub y: f64,
    /// Clockwise, in degrees; it counts turns, so it may be any number.
    pub heading_deg: f64,
}

impl Pose {
    /// The pose after the wheels have rolled so far, in mm: an exact arc.
    #[must_use]
    pub fn moved(self, left_mm: f64, right_mm: f64, track_mm: f64) -> Self {
        let turned_deg = ((left_mm - right_mm) / track_mm).to_degrees();
        let half_deg = turned_deg / 2.0;
        let half = half_deg.to_radians();
        // The chord of the arc; its direction is the mean heading.
        let chord = f64::midpoint(left_mm, right_mm)
            * if half.abs() < 1e-4 {
                1.0 - half * half / 6.0
            } else {
                sin_cos(half_deg).0 / half
            };
        let (sin, cos) = sin_cos(self.heading_deg + half_deg);
        Self {
            x: self.x + chord * sin,
            y: self.y + chord * cos,
            heading_deg: self.heading_deg + turned_deg,
        }
    }
}

/// A step of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// When it ended.
    pub until: Instant,
    /// The pose then.
    pub pose: Pose,
    /// The motion during the step; zero where it is unknown.
    pub motion: Motion,
    /// How the motion is known.
    pub link: Link,
}

/// A wheel and its way.
#[derive(Clone, Debug, PartialEq)]
struct Rolling {
    is_right: bool,
    forward_sign: f64,
    track: WheelTrack,
}

/// Adds up the motion of the vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Odometer {
    geometry: Geometry,
    wheels: Vec<Rolling>,
    /// Up to when the motion is counted.
    counted_us: Option<u64>,
    pose: Pose,
    driven_mm: f64,
}

impl Odometer {
    /// At the beginning, before any reply.
    #[must_use]
    pub fn new(vehicle: &Vehicle, geometry: Geometry) -> Self {
        let rolling = |wheel: &Wheel| Rolling {
            is_right: wheel.is_right,
            forward_sign: wheel.forward_sign(),
            track: WheelTrack::default(),
        };
        Self {
            geometry,
            wheels: vehicle.wheels().iter().map(rolling).collect(),
            counted_us: None,
            pose: Pose::default(),
            driven_mm: 0.0,
        }
    }

    /// The present pose.
    #[must_use]
    pub const fn pose(&self) -> Pose {
        self.pose
    }

    /// The length of the way, back and forth, in mm.
    #[must_use]
    pub const fn driven_mm(&self) -> f64 {
        self.driven_mm
    }

    /// When the last reply of this wheel was read.
    #[must_use]
    pub fn newest(&self, place: usize) -> Option<Instant> {
        let newest_us = self.wheels.get(place)?.track.newest_us();
        newest_us.map(Instant::from_micros)
    }

    /// The place of the first wheel whose angle does not follow its speed, if there is one.
    #[must_use]
    pub fn misfit(&self) -> Option<usize> {
        let mut wheels = self.wheels.iter();
        wheels.position(|wheel| wheel.track.angle_misfits())
    }

    /// Takes a reply of a wheel, by its place in the vehicle.
    pub fn report(&mut self, place: usize, report: Report) {
        if let Some(wheel) = self.wheels.get_mut(place) {
            wheel.track.report(report);
        }
    }

    /// Counts the motion as far as all wheels have reported, and calls `each` with every step. A wheel that has not
    /// reported for the time of a gap is not waited for.
    pub fn advance(&mut self, mut each: impl FnMut(Step)) {
        let newest = |wheel: &Rolling| wheel.track.newest_us();
        let Some(newest_us) = self.wheels.iter().filter_map(newest).max() else {
            return;
        };
        let waits_until = newest_us.saturating_sub(GAP_OVER_US);
        let reported = self.wheels.iter().map(|wheel| newest(wheel).unwrap_or(0));
        let until_us = reported.min().unwrap_or(0).max(waits_until);
        let Some(mut at_us) = self.counted_us else {
            // What came before both sides have reported is no gap.
            let reports = |right| {
                let mut of_side = self.wheels.iter().filter(|wheel| wheel.is_right == right);
                of_side.any(|wheel| newest(wheel).is_some())
            };
            self.counted_us = (reports(false) && reports(true)).then_some(newest_us);
            return;
        };
        while at_us + TICK_US <= until_us {
            let to_us = at_us + TICK_US;
            let sides = (
                self.side_mm(false, at_us, to_us),
                self.side_mm(true, at_us, to_us),
            );
            let mut step = Step {
                until: Instant::from_micros(to_us),
                pose: self.pose,
                motion: Motion::default(),
                link: Link::Unknown,
            };
            if let (Some((left, of_left)), Some((right, of_right))) = sides {
                self.pose = self.pose.moved(left, right, self.geometry.track_mm());
                self.driven_mm += f64::midpoint(left, right).abs();
                step.motion = Motion {
                    forward_mm_per_s: f64::midpoint(left, right) * TICKS_PER_S,
                    turn_deg_per_s: (self.pose.heading_deg - step.pose.heading_deg) * TICKS_PER_S,
                };
                step.pose = self.pose;
                step.link = of_left.min(of_right);
            }
            each(step);
            at_us = to_us;
        }
        self.counted_us = Some(at_us);
        for wheel in &mut self.wheels {
            wheel.track.forget_before(at_us);
        }
    }

    /// How far a side has rolled forward in mm: the mean of the wheels that are known best.
    fn side_mm(&self, right: bool, from_us: u64, to_us: u64) -> Option<(f64, Link)> {
        let (mut sum, mut count, mut best) = (0.0, 0.0, Link::Unknown);
        for wheel in self.wheels.iter().filter(|wheel| wheel.is_right == right) {
            let Some((turns, link)) = wheel.track.turns_between(from_us, to_us) else {
                continue;
            };
            if link > best {
                (sum, count, best) = (0.0, 0.0, link);
            }
            if link == best {
                sum += wheel.forward_sign * turns;
                count += 1.0;
            }
        }
        let mm_a_turn = std::f64::consts::TAU * self.geometry.radius_mm();
        (count > 0.0).then(|| (mm_a_turn * sum / count, best))
    }
}

#[cfg(test)]
#[path = "odometry_tests.rs"]
mod tests;
