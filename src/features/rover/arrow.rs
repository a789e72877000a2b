//! The arrow that shows the motion of the vehicle.

use std::fmt::Write;

use motorlink_messages::experiments::{
    odometry::Pose,
    vehicle::{Geometry, Motion, Place},
};

/// An arrow shows where a point of the vehicle is after this time: at 200 rpm it is as long as the vehicle.
const SHOWN_S: f64 = 0.25;
/// An arrow is an arc in so many pieces.
const PIECES: u32 = 8;
/// A slower vehicle stands: a motor's reported speed has steps of 1 rpm.
const STANDS_BELOW_MM_PER_S: f64 = 2.0;

/// The way of a point that is this far ahead of the middle, as path data seen from above; empty at a standstill.
/// It begins at the end of the vehicle that goes first.
pub(crate) fn arrow(motion: Motion, geometry: Geometry, ahead_mm: f64) -> String {
    let side_mm = motion.turn_deg_per_s.to_radians() * geometry.track_mm() / 2.0;
    if motion.forward_mm_per_s.abs() + side_mm.abs() < STANDS_BELOW_MM_PER_S {
        return String::new();
    }
    let from = if motion.forward_mm_per_s < -1.0 {
        -ahead_mm
    } else {
        ahead_mm
    };
    let mut path = String::new();
    for piece in 0..=PIECES {
        let s = SHOWN_S * f64::from(piece) / f64::from(PIECES);
        let (left, right) = (
            motion.forward_mm_per_s + side_mm,
            motion.forward_mm_per_s - side_mm,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::vehicle::{tests::names, vehicle_of};

    #[test]
    fn the_arrow_begins_at_the_end_that_goes_first_and_none_is_drawn_at_a_standstill() {
        let geometry = Geometry::new(50, 300).unwrap();
        let vehicle = vehicle_of(&names(2)).unwrap();
        let arrow = |left, right| {
            let motion = Motion::of(&vehicle, geometry, &[Some(left), Some(right)]);
            arrow(motion.unwrap(), geometry, 200.0)
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
