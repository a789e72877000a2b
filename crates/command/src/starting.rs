//! The command that starts motors, or changes what is driven.

use motorlink_bus::{Command, Consent, GroupError, GroupSetpoints};
use motorlink_protocol::{MotorId, Setpoint};

use crate::signed_id::SignedId;

/// Starts these motors, each with the sign of its side: one alone, or several together.
///
/// # Errors
/// They cannot form a group.
pub fn start(
    motors: impl IntoIterator<Item = SignedId>,
    setpoint: Setpoint,
    consent: Consent,
) -> Result<Command, GroupError> {
    Ok(match entries(motors, setpoint).as_slice() {
        [(id, setpoint)] => Command::Start {
            id: *id,
            setpoint: *setpoint,
            consent,
        },
        entries => Command::StartGroup {
            setpoints: GroupSetpoints::new(entries)?,
            consent,
        },
    })
}

/// Changes the setpoint of what is driven. It starts nothing.
///
/// # Errors
/// They cannot form a group.
pub fn adjust(
    motors: impl IntoIterator<Item = SignedId>,
    setpoint: Setpoint,
    consent: Consent,
) -> Result<Command, GroupError> {
    Ok(match entries(motors, setpoint).as_slice() {
        [(id, setpoint)] => Command::Adjust {
            id: *id,
            setpoint: *setpoint,
            consent,
        },
        entries => Command::AdjustGroup {
            setpoints: GroupSetpoints::new(entries)?,
            consent,
        },
    })
}

fn entries(
    motors: impl IntoIterator<Item = SignedId>,
    setpoint: Setpoint,
) -> Vec<(MotorId, Setpoint)> {
    let of = |motor: SignedId| (motor.id, motor.mirror.setpoint(setpoint));
    motors.into_iter().map(of).collect()
}
