//! The motion of the vehicle from the speeds of its wheels, and the arrow that shows it.

use std::fmt::Write;

use crate::features::rover::{
    geometry::Geometry,
    odometry::Pose,
    vehicle::{Place, Vehicle},
};

/// An arrow shows where a point of the vehicle is after this time: at 200 rpm it is as long as the vehicle.
const SHOWN_S: f64 = 0.25;
/// An arrow is an arc in so many pieces.
const PIECES: u32 = 8;
/// A slower vehicle stands: a motor's reported speed has steps of 1 rpm.
const STANDS_BELOW_MM_PER_S: f64 = 2.0;

/// The motion of the vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Motion {
    pub(crate) forward_mm_per_s: f64,
    /// Clockwise, which is to the right.
    pub(crate) turn_deg_per_s: f64,
}

impl Motion {
    /// From the speed of each wheel, + is forward, in the order of the vehicle's wheels; `None` unless a wheel of each
    /// side has a speed.
    pub(crate) fn of(vehicle: &Vehicle, geometry: Geometry, rpm: &[Option<f64>]) -> Option<Self> {
        let side = |right: bool| {
            let wheels = vehicle.wheels().iter().zip(rpm);
            let (mut sum, mut count) = (0.0, 0.0);
            for (_, rpm) in wheels.filter(|(wheel, _)| wheel.is_right == right) {
                if let Some(rpm) = rpm {
                    sum += rpm;
                    count += 1.0;
                }
            }
            let mm_a_turn = std::f64::consts::TAU * geometry.radius_mm();
            (count > 0.0).then(|| sum / count / 60.0 * mm_a_turn)
        };
        let (left, right) = (side(false)?, side(true)?);
        Some(Self {
            forward_mm_per_s: f64::midpoint(left, right),
            turn_deg_per_s: ((left - right) / geometry.track_mm()).to_degrees(),
        })
    }

    /// The way of a point that is this far ahead of the middle, as path data seen from above; empty at a standstill.
    /// It begins at the end of the vehicle that goes first.
    pub(crate) fn arrow(self, geometry: Geometry, ahead_mm: f64) -> String {
        let side_mm = self.turn_deg_per_s.to_radians() * geometry.track_mm() / 2.0;
        if self.forward_mm_per_s.abs() + side_mm.abs() < STANDS_BELOW_MM_PER_S {
            return String::new();
        }
        let from = if self.forward_mm_per_s < -1.0 {
            -ahead_mm
        } else {
            ahead_mm
        };
        let mut path = String::new();
        for piece in 0..=PIECES {
            let s = SHOWN_S * f64::from(piece) / f64::from(PIECES);
            let (left, right) = (
                self.forward_mm_per_s + side_mm,
                self.forward_mm_per_s - side_mm,
            );
            let pose = Pose::default().moved(left * s, right * s, geometry.track_mm());
            let (sin, cos) = crate::ui::mathematics::sin_cos(pose.heading_deg);
            let at = Place {
                x: pose.x + from * sin,
                y: -(pose.y + from * cos),
            };
            let command = if piece == 0 { 'M' } else { 'L' };
            // Writing to a string cannot fail.
            let _ = write!(path, "{command}{:.1} {:.1}", at.x, at.y);
        }
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::rover::vehicle::tests::names;

    fn motion(rpm: &[Option<f64>]) -> Option<Motion> {
        let count = u8::try_from(rpm.len()).unwrap();
        let vehicle = Vehicle::of(&names(count)).unwrap();
        Motion::of(&vehicle, Geometry::new(50, 300).unwrap(), rpm)
    }

    #[test]
    fn both_sides_ahead_is_ahead_and_the_left_one_alone_turns_to_the_right() {
        let ahead = motion(&[Some(60.0), Some(60.0)]).unwrap();
        assert!((ahead.forward_mm_per_s - 314.159).abs() < 0.001);
        assert!(ahead.turn_deg_per_s.abs() < 1e-9);
        let to_the_right = motion(&[Some(60.0), Some(-60.0)]).unwrap();
        assert!(to_the_right.forward_mm_per_s.abs() < 1e-9);
        assert!((to_the_right.turn_deg_per_s - 120.0).abs() < 1e-9);
    }

    #[test]
    fn a_side_without_a_speed_leaves_the_motion_unknown() {
        assert_eq!(motion(&[Some(60.0), None]), None);
        let of_three = motion(&[Some(60.0), Some(-60.0), None, Some(-60.0)]);
        assert_eq!(of_three, motion(&[Some(60.0), Some(-60.0)]));
    }

    #[test]
    fn the_arrow_begins_at_the_end_that_goes_first_and_none_is_drawn_at_a_standstill() {
        let geometry = Geometry::new(50, 300).unwrap();
        let arrow = |left, right| {
            motion(&[Some(left), Some(right)])
                .unwrap()
                .arrow(geometry, 200.0)
        };
        assert_eq!(arrow(0.0, 0.0), "");
        let ahead = arrow(60.0, 60.0);
        assert!(ahead.starts_with("M0.0 -200.0L"), "{ahead}");
        assert!(ahead.ends_with("L0.0 -278.5"), "{ahead}");
        let back = arrow(-60.0, -60.0);
        assert!(back.starts_with("M0.0 200.0L"), "{back}");
        // On the spot, the nose goes to the right by 30 degrees.
        let on_the_spot = arrow(60.0, -60.0);
        assert!(on_the_spot.ends_with("L100.0 -173.2"), "{on_the_spot}");
    }
}
