//! The rover: its wheels, and the speed of each for a twist. A differential drive; axes and signs of REP 103: x ahead, y to the left,
//! turns to the left are positive.

use motorlink_protocol::MotorId;

use crate::node::messages::Twist;

/// A wheel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wheel {
    /// Its motor.
    pub id: MotorId,
    /// Its joint in the robot's description.
    pub joint: String,
    /// On the right. Its motor is mounted mirrored.
    pub is_right: bool,
}

impl Wheel {
    /// The sign of the motor's own speed that drives ahead.
    #[must_use]
    pub const fn sign(&self) -> f64 {
        if self.is_right { -1.0 } else { 1.0 }
    }
}

/// Wheels and measures.
#[derive(Clone, Debug, PartialEq)]
pub struct Rover {
    /// At least one on each side.
    pub wheels: Vec<Wheel>,
    /// Of the wheels.
    pub radius_m: f64,
    /// Between the middles of the left and the right wheels.
    pub track_m: f64,
    /// No wheel is asked for more.
    pub speed_max_rad_per_s: f64,
}

impl Rover {
    /// The speed of each motor in rad/s, in its own direction. A twist that is too fast for a wheel is made slower as a whole: the robot
    /// stays on its path.
    #[must_use]
    pub fn speeds(&self, twist: &Twist) -> Vec<(MotorId, f32)> {
        let half_m = self.track_m / 2.0;
        let ahead = |wheel: &Wheel| {
            let side = if wheel.is_right { 1.0 } else { -1.0 };
            (twist.linear.x + side * half_m * twist.angular.z) / self.radius_m
        };
        let fastest = self.wheels.iter().map(|wheel| ahead(wheel).abs());
        let fastest = fastest.fold(self.speed_max_rad_per_s, f64::max);
        let scale = self.speed_max_rad_per_s / fastest;
        let speed = |wheel: &Wheel| {
            #[expect(clippy::cast_possible_truncation, reason = "the motors take whole rpm")]
            let speed = (wheel.sign() * scale * ahead(wheel)) as f32;
            (wheel.id, speed)
        };
        self.wheels.iter().map(speed).collect()
    }

    /// The twist of the robot from how fast the wheels of each side drive ahead, in rad/s.
    #[must_use]
    pub fn twist(&self, left: f64, right: f64) -> Twist {
        let (left, right) = (left * self.radius_m, right * self.radius_m);
        let mut twist = Twist::default();
        twist.linear.x = f64::midpoint(left, right);
        twist.angular.z = (right - left) / self.track_m;
        twist
    }

    /// No speed for each motor.
    #[must_use]
    pub fn at_rest(&self) -> Vec<(MotorId, f32)> {
        self.wheels.iter().map(|wheel| (wheel.id, 0.0)).collect()
    }
}

/// Tests of other modules use its rover.
#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Motors 1 (left) and 2 (right), wheels of 50 mm, 300 mm apart, at most 20 rad/s.
    pub(crate) fn rover() -> Rover {
        let wheel = |id, is_right| Wheel {
            id: MotorId::new(id).unwrap(),
            joint: format!("wheel_{id}_joint"),
            is_right,
        };
        Rover {
            wheels: vec![wheel(1, false), wheel(2, true)],
            radius_m: 0.05,
            track_m: 0.3,
            speed_max_rad_per_s: 20.0,
        }
    }

    /// Ahead and to the left.
    pub(crate) fn twist(x: f64, z: f64) -> Twist {
        let mut twist = Twist::default();
        (twist.linear.x, twist.angular.z) = (x, z);
        twist
    }

    fn assert_speeds(x: f64, z: f64, expected: [f32; 2]) {
        let speeds = rover().speeds(&twist(x, z));
        for ((_, speed), expected) in speeds.iter().zip(expected) {
            assert!((speed - expected).abs() < 1e-4, "{speeds:?}");
        }
    }

    #[test]
    fn ahead_turns_the_right_motor_backward_and_left_is_positive() {
        assert_speeds(0.5, 0.0, [10.0, -10.0]);
        assert_speeds(-0.5, 0.0, [-10.0, 10.0]);
        assert_speeds(0.0, 2.0, [-6.0, -6.0]);
        assert_speeds(0.0, 0.0, [0.0, -0.0]);
    }

    #[test]
    fn a_twist_that_is_too_fast_keeps_its_path() {
        // 40 and 80 rad/s: half of 40 and of 20.
        assert_speeds(3.0, 20.0 / 3.0, [10.0, -20.0]);
    }

    #[test]
    fn the_twist_of_the_wheels_is_the_one_that_was_asked() {
        let back = rover().twist(4.0, 16.0);
        assert!((back.linear.x - 0.5).abs() < 1e-12 && (back.angular.z - 2.0).abs() < 1e-12);
    }
}
