//! The position of a speed on the ring around the wheel.

use motorlink_messages::protocol::SpeedTarget;

use crate::ui::mathematics::limited;

/// Speed at both ends of the ring, in rpm: the greatest that can be commanded.
#[allow(
    clippy::cast_precision_loss,
    reason = "a limit of a few hundred rpm is exact in any float"
)]
pub const LIMIT_RPM: f64 = SpeedTarget::MAX as f64;

/// Bearing of both ends, in degrees from the top. The gap of sixty degrees at the bottom separates the ends and has
/// room for their labels.
pub const END_DEG: f64 = 150.0;

/// The bearing of a speed; beyond the limit, the end.
///
/// Positive speeds turn the wheel counter-clockwise and are on the left, so that the arc grows in the direction of
/// rotation.
#[must_use]
pub fn bearing_deg(rpm: f64) -> f64 {
    -clamped(rpm) / LIMIT_RPM * END_DEG
}

/// A dash along the ring, in rpm from its beginning at the negative end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dash {
    /// Start, 0 to twice the limit.
    pub start: f64,
    /// Length, 0 to the limit.
    pub length: f64,
}

/// The part of the ring between zero and a speed.
#[must_use]
pub fn dash(rpm: f64) -> Dash {
    let rpm = clamped(rpm);
    Dash {
        start: LIMIT_RPM + rpm.min(0.0),
        length: rpm.abs(),
    }
}

fn clamped(rpm: f64) -> f64 {
    if rpm.is_nan() {
        0.0
    } else {
        limited(rpm, -LIMIT_RPM, LIMIT_RPM)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-9, "{a} is not {b}");
    }

    #[test]
    fn counter_clockwise_speeds_stand_on_the_left() {
        assert_near(bearing_deg(0.0), 0.0);
        assert_near(bearing_deg(330.0), -150.0);
        assert_near(bearing_deg(-330.0), 150.0);
        assert_near(bearing_deg(110.0), -50.0);
    }

    #[test]
    fn beyond_the_limit_is_the_end_of_the_scale() {
        assert_near(bearing_deg(1000.0), -150.0);
        assert_near(bearing_deg(f64::NAN), 0.0);
        assert_near(dash(-999.0).length, 330.0);
    }

    #[test]
    fn the_arc_reaches_from_zero_to_the_speed_on_its_own_side() {
        assert_eq!(
            dash(100.0),
            Dash {
                start: 330.0,
                length: 100.0
            }
        );
        assert_eq!(
            dash(-100.0),
            Dash {
                start: 230.0,
                length: 100.0
            }
        );
    }
}
