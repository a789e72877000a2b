//! How one motor is stopped.

use motorlink_messages::{
    bus::{Activity, Command, Consent},
    protocol::{CurrentTarget, Mode, MotorId, Setpoint},
};

use crate::model::tab::Tab;

/// How to stop one motor: as its loop allows if it is driven, else by the brake.
///
/// In the current loop that is 0 A, and the wheel coasts; in the position loop it holds the present angle. The tabs
/// of these loops do not stop a motor that they do not drive. A tool brakes it, because a raw frame may have moved
/// it.
pub(crate) fn stop_of(id: MotorId, activity: Option<Activity>, tab: Tab) -> Option<Command> {
    let mode = match activity {
        Some(Activity::Driven { setpoint }) => setpoint.mode(),
        Some(Activity::Switching { .. } | Activity::DrivenRaw) => return Some(Command::Stop(id)),
        _ => match tab {
            Tab::Loop(Mode::OpenLoop | Mode::Current | Mode::Position) => return None,
            Tab::Loop(Mode::Velocity) | Tab::IdManager | Tab::RawHex => {
                return Some(Command::Stop(id));
            }
        },
    };
    Some(match mode {
        Mode::Velocity | Mode::OpenLoop => Command::Stop(id),
        Mode::Current => Command::Drive {
            id,
            setpoint: Setpoint::Current(CurrentTarget::ZERO),
            consent: Consent::None,
        },
        Mode::Position => Command::Hold(id),
    })
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::PositionTarget;

    use super::*;

    const ID: MotorId = MotorId::FIRST;

    #[test]
    fn a_stop_is_what_the_driven_loop_allows_whatever_tab_is_open() {
        let driven = |setpoint| Some(Activity::Driven { setpoint });
        let zero_amps = Command::Drive {
            id: ID,
            setpoint: Setpoint::Current(CurrentTarget::ZERO),
            consent: Consent::None,
        };
        for tab in Tab::ALL {
            let stop = |activity| stop_of(ID, activity, tab);
            assert_eq!(stop(driven(Setpoint::Brake)), Some(Command::Stop(ID)));
            let current = Setpoint::Current(CurrentTarget::from_amps(1.0));
            assert_eq!(stop(driven(current)), Some(zero_amps));
            let position = Setpoint::Position(PositionTarget::default());
            assert_eq!(stop(driven(position)), Some(Command::Hold(ID)));
            let switching = Some(Activity::Switching { to: Mode::Current });
            assert_eq!(stop(switching), Some(Command::Stop(ID)));
        }
    }

    #[test]
    fn a_motor_that_is_not_driven_is_left_alone_by_the_tabs_that_do_not_brake() {
        for (tab, command) in [
            (Tab::Loop(Mode::Velocity), Some(Command::Stop(ID))),
            (Tab::Loop(Mode::Current), None),
            (Tab::Loop(Mode::Position), None),
            (Tab::IdManager, Some(Command::Stop(ID))),
            (Tab::RawHex, Some(Command::Stop(ID))),
        ] {
            for activity in [None, Some(Activity::Idle)] {
                assert_eq!(stop_of(ID, activity, tab), command);
            }
        }
    }
}
