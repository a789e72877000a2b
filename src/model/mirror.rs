//! Reverses the sign of speed and current for motors that are mounted mirrored.
//!
//! It is applied to the worker's state in [`Session::with_mirroring`], to drawn points of the history, and to
//! commands in [`to_wire`]. The digital twin, the packet log, raw frames and recordings have the signs of the
//! wire.
//!
//! [`Session::with_mirroring`]: crate::model::snapshot::Session::with_mirroring

pub(crate) use motorlink_messages::bus::Mirror;
use motorlink_messages::{bus::Command, protocol::MotorId};

/// The command for the bus. Setpoints of a group already have the signs of the wire: see
/// [`crate::features::groups::wheels::group_setpoints`].
pub(crate) fn to_wire(mut command: Command, mirror: impl Fn(MotorId) -> Mirror) -> Command {
    if let Command::Start { id, setpoint, .. }
    | Command::Drive { id, setpoint, .. }
    | Command::Adjust { id, setpoint, .. } = &mut command
    {
        *setpoint = mirror(*id).setpoint(*setpoint);
    }
    command
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        bus::{Consent, GroupSetpoints},
        protocol::{Acceleration, CurrentTarget, Setpoint, SpeedTarget},
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
