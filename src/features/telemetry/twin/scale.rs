//! The position of a speed on the ring around the wheel.

use crate::ui::mathematics::limited;

/// Bearing of both ends, in degrees from the top. The gap of sixty degrees at the bottom separates the ends and has
/// room for their labels.
pub const END_DEG: f64 = 150.0;

/// A dash along the ring, in rpm from its beginning at the negative end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dash {
    /// Start, 0 to twice the limit.
    pub start: f64,
    /// Length, 0 to the limit.
    pub length: f64,
}

/// The scale of the ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedScale {
    /// Speed at both ends in rpm: the greatest that the model takes.
    pub limit_rpm: f64,
}

impl SpeedScale {
    /// The bearing of a speed; beyond the limit, the end.
    ///
    /// Positive speeds turn the wheel counter-clockwise and are on the left, so that the arc grows in the direction of
    /// rotation.
    #[must_use]
    pub fn bearing_deg(self, rpm: f64) -> f64 {
        -self.clamped(rpm) / self.limit_rpm * END_DEG
    }

    /// The part of the ring between zero and a speed.
    #[must_use]
    pub fn dash(self, rpm: f64) -> Dash {
        let rpm = self.clamped(rpm);
        Dash {
            start: self.limit_rpm + rpm.min(0.0),
            length: rpm.abs(),
        }
    }

    fn clamped(self, rpm: f64) -> f64 {
        if rpm.is_nan() {
            0.0
        } else {
            limited(rpm, -self.limit_rpm, self.limit_rpm)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALE: SpeedScale = SpeedScale { limit_rpm: 330.0 };

    fn assert_near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-9, "{a} is not {b}");
    }

    #[test]
    fn counter_clockwise_speeds_stand_on_the_left() {
        assert_near(SCALE.bearing_deg(0.0), 0.0);
        assert_near(SCALE.bearing_deg(330.0), -150.0);
        assert_near(SCALE.bearing_deg(-330.0), 150.0);
        assert_near(SCALE.bearing_deg(110.0), -50.0);
    }

    #[test]
    fn beyond_the_limit_is_the_end_of_the_scale() {
        assert_near(SCALE.bearing_deg(1000.0), -150.0);
        assert_near(SCALE.bearing_deg(f64::NAN), 0.0);
        assert_near(SCALE.dash(-999.0).length, 330.0);
    }

    #[test]
    fn the_arc_reaches_from_zero_to_the_speed_on_its_own_side() {
        assert_eq!(
            SCALE.dash(100.0),
            Dash {
                start: 330.0,
                length: 100.0
            }
        );
        assert_eq!(
            SCALE.dash(-100.0),
            Dash {
                start: 230.0,
                length: 100.0
            }
        );
    }
}
