//! How one motor is stopped.

use motorlink_messages::{
    bus::{Activity, Command, Consent},
    protocol::{CurrentTarget, Mode, MotorId, Setpoint},
};

/// How to stop one motor: as its loop allows if it is driven, else by the brake.
///
/// In the current loop that is 0 A, and the wheel coasts; in the position loop it holds the present angle. The brake is
/// for all others: the page may not have heard yet of a start, and a raw frame may have moved the wheel.
pub(crate) fn stop_of(id: MotorId, activity: Option<Activity>) -> Command {
    let Some(Activity::Driven { setpoint }) = activity else {
        return Command::Stop(id);
    };
    match setpoint.mode() {
        Mode::Velocity | Mode::OpenLoop => Command::Stop(id),
        Mode::Current => Command::Drive {
            id,
            setpoint: Setpoint::Current(CurrentTarget::ZERO),
            consent: Consent::None,
        },
        Mode::Position => Command::Hold(id),
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::PositionTarget;

    use super::*;

    const ID: MotorId = MotorId::FIRST;

    #[test]
    fn a_stop_is_what_the_driven_loop_allows() {
        let stop = |setpoint| stop_of(ID, Some(Activity::Driven { setpoint }));
        assert_eq!(stop(Setpoint::Brake), Command::Stop(ID));
        let zero_amps = Command::Drive {
            id: ID,
            setpoint: Setpoint::Current(CurrentTarget::ZERO),
            consent: Consent::None,
        };
        let current = Setpoint::Current(CurrentTarget::from_amps(1.0));
        assert_eq!(stop(current), zero_amps);
        let position = Setpoint::Position(PositionTarget::default());
        assert_eq!(stop(position), Command::Hold(ID));
    }

    #[test]
    fn a_motor_that_is_not_known_to_be_driven_is_braked() {
        for activity in [
            None,
            Some(Activity::Idle),
            Some(Activity::Switching { to: Mode::Current }),
            Some(Activity::Stopping { confirmed: false }),
            Some(Activity::DrivenRaw),
        ] {
            assert_eq!(stop_of(ID, activity), Command::Stop(ID));
        }
    }
}
