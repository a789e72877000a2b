//! Reverses the sign of speed and current for motors that are mounted mirrored, such as those on the right
//! side of a vehicle.
//!
//! The bus itself has the signs of the wire.

use motorlink_protocol::{Current, Rpm, Setpoint};

use crate::motor_status::Activity;

/// The sign of a motor's speed and current for the operator. Applying it twice has no effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mirror {
    /// As on the wire: + is counter-clockwise, seen from the motor's face.
    #[default]
    Straight,
    /// Reversed: + is clockwise, seen from the motor's face.
    Mirrored,
}

impl Mirror {
    /// Whether it reverses.
    #[must_use]
    pub const fn is_mirrored(self) -> bool {
        matches!(self, Self::Mirrored)
    }

    /// A speed.
    #[must_use]
    pub const fn speed(self, speed: Rpm) -> Rpm {
        match self {
            Self::Straight => speed,
            Self::Mirrored => Rpm::new(speed.rpm().saturating_neg()),
        }
    }

    /// A current.
    #[must_use]
    pub const fn current(self, current: Current) -> Current {
        match self {
            Self::Straight => current,
            Self::Mirrored => Current::from_raw(current.raw().saturating_neg()),
        }
    }

    /// A setpoint. Angles and the brake do not change.
    #[must_use]
    pub fn setpoint(self, setpoint: Setpoint) -> Setpoint {
        match self {
            Self::Straight => setpoint,
            Self::Mirrored => setpoint.reversed(),
        }
    }

    /// The setpoint of an activity.
    #[must_use]
    pub fn activity(self, activity: Activity) -> Activity {
        match activity {
            Activity::Driven { setpoint } => Activity::Driven {
                setpoint: self.setpoint(setpoint),
            },
            other => other,
        }
    }
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{Acceleration, CurrentTarget, PositionTarget, SpeedTarget};

    use super::*;
    use crate::safety::needs_consent;

    fn rpm(rpm: i32) -> Setpoint {
        Setpoint::Velocity {
            speed: SpeedTarget::new(rpm).unwrap(),
            acceleration: Acceleration::new(7),
        }
    }

    fn raw(raw: i32) -> Setpoint {
        Setpoint::Current(CurrentTarget::new(raw).unwrap())
    }

    #[test]
    fn a_mirrored_motor_has_the_other_sign_in_speed_and_current_alone() {
        let angle = Setpoint::Position(PositionTarget::from_degrees(90.0));
        for (asked, sent) in [
            (rpm(100), rpm(-100)),
            (rpm(-330), rpm(330)),
            (rpm(0), rpm(0)),
            (raw(32_767), raw(-32_767)),
            (raw(-5), raw(5)),
            (Setpoint::Brake, Setpoint::Brake),
            (angle, angle),
        ] {
            assert_eq!(Mirror::Mirrored.setpoint(asked), sent);
            assert_eq!(Mirror::Mirrored.setpoint(sent), asked, "and back");
            assert_eq!(Mirror::Straight.setpoint(asked), asked);
        }
    }

    /// The most negative value of a reply has no positive counterpart.
    #[test]
    fn the_ends_of_what_a_reply_can_hold_are_mirrored_too() {
        let mirror = Mirror::Mirrored;
        for (reported, read) in [(100, -100), (i16::MAX, -i16::MAX), (i16::MIN, i16::MAX)] {
            assert_eq!(mirror.speed(Rpm::new(reported)), Rpm::new(read));
            let current = mirror.current(Current::from_raw(reported));
            assert_eq!(current, Current::from_raw(read));
        }
        assert_eq!(Mirror::Straight.speed(Rpm::new(-3)), Rpm::new(-3));
    }

    #[test]
    fn a_current_that_has_to_be_asked_about_has_to_be_either_way() {
        for size in [25_000, 25_001, 32_767] {
            let mirrored = Mirror::Mirrored.setpoint(raw(size));
            assert_eq!(needs_consent(raw(size)), needs_consent(mirrored), "{size}");
        }
    }
}
