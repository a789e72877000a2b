//! Reverses the sign of speed and current for motors that are mounted mirrored, such as those on the right
//! side of a vehicle.
//!
//! It is applied to the worker's state in [`Session::with_mirroring`], to drawn points of the history, and to
//! commands in [`to_wire`]. The digital twin, the packet log, raw frames and recordings have the signs of the
//! wire.
//!
//! [`Session::with_mirroring`]: crate::model::snapshot::Session::with_mirroring

use motorlink_messages::{
    bus::{Activity, Command},
    protocol::{Current, CurrentTarget, MotorId, Rpm, Setpoint, SpeedTarget},
};

/// The sign of a motor's speed and current for the operator. Applying it twice has no effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Mirror {
    /// As on the wire: + is counter-clockwise, seen from the motor's face.
    #[default]
    Straight,
    /// Reversed: + is clockwise, seen from the motor's face.
    Mirrored,
}

impl Mirror {
    pub(crate) fn is_mirrored(self) -> bool {
        self == Self::Mirrored
    }

    pub(crate) fn speed(self, speed: Rpm) -> Rpm {
        match self {
            Self::Straight => speed,
            Self::Mirrored => Rpm::new(speed.rpm().saturating_neg()),
        }
    }

    pub(crate) fn current(self, current: Current) -> Current {
        match self {
            Self::Straight => current,
            Self::Mirrored => Current::from_raw(current.raw().saturating_neg()),
        }
    }

    /// Angles and the brake do not change.
    pub(crate) fn setpoint(self, setpoint: Setpoint) -> Setpoint {
        match (self, setpoint) {
            (
                Self::Mirrored,
                Setpoint::Velocity {
                    speed,
                    acceleration,
                },
            ) => Setpoint::Velocity {
                speed: SpeedTarget::clamped(-i32::from(speed.rpm())),
                acceleration,
            },
            // The range is symmetric, so the result is in range.
            (Self::Mirrored, Setpoint::Current(target)) => {
                Setpoint::Current(CurrentTarget::new(-i32::from(target.raw())).unwrap_or_default())
            }
            (Self::Mirrored, Setpoint::OpenLoop(target)) => Setpoint::OpenLoop(target.reversed()),
            (_, setpoint) => setpoint,
        }
    }

    pub(crate) fn activity(self, activity: Activity) -> Activity {
        match activity {
            Activity::Driven { setpoint } => Activity::Driven {
                setpoint: self.setpoint(setpoint),
            },
            other => other,
        }
    }
}

/// The command for the bus. Setpoints of a group already have the signs of the wire: see
/// [`crate::features::groups::wheels::group_setpoints`].
pub(crate) fn to_wire(command: Command, mirror: impl Fn(MotorId) -> Mirror) -> Command {
    match command {
        Command::Start {
            id,
            setpoint,
            consent,
        } => Command::Start {
            id,
            setpoint: mirror(id).setpoint(setpoint),
            consent,
        },
        Command::Drive {
            id,
            setpoint,
            consent,
        } => Command::Drive {
            id,
            setpoint: mirror(id).setpoint(setpoint),
            consent,
        },
        Command::Adjust {
            id,
            setpoint,
            consent,
        } => Command::Adjust {
            id,
            setpoint: mirror(id).setpoint(setpoint),
            consent,
        },
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        bus::{Consent, GroupSetpoints, needs_consent},
        protocol::{Acceleration, PositionTarget},
    };

    use super::*;
    use crate::model::scan_texts::tests::id;

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

    #[test]
    fn a_command_for_one_motor_is_mirrored_and_one_for_a_group_is_as_it_is() {
        let right = |of| {
            if of == id(2) {
                Mirror::Mirrored
            } else {
                Mirror::Straight
            }
        };
        let drive = |of, setpoint| Command::Drive {
            id: id(of),
            setpoint,
            consent: Consent::HighCurrent,
        };
        let adjust = |of, setpoint| Command::Adjust {
            id: id(of),
            setpoint,
            consent: Consent::None,
        };
        let together = Command::StartGroup {
            setpoints: GroupSetpoints::new(&[(id(1), rpm(80)), (id(2), rpm(-80))]).unwrap(),
            consent: Consent::None,
        };
        for (asked, sent) in [
            (drive(2, raw(30_000)), drive(2, raw(-30_000))),
            (drive(1, rpm(50)), drive(1, rpm(50))),
            (adjust(2, rpm(50)), adjust(2, rpm(-50))),
            (adjust(1, rpm(50)), adjust(1, rpm(50))),
            (together, together),
            (Command::Stop(id(2)), Command::Stop(id(2))),
            (Command::Hold(id(2)), Command::Hold(id(2))),
        ] {
            assert_eq!(to_wire(asked, right), sent);
        }
    }
}
