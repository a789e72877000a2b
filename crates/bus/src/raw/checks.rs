//! Whether a raw frame may go to a motor now.

use motorlink_protocol::{CurrentTarget, Mode, MotorId, Rpm, Setpoint, family::Model};

use crate::{
    command::Consent,
    limits::Limits,
    model::units,
    raw::frame::RawEffect,
    refusal::Refusal,
    safety::{Known, check_position_switch, needs_consent},
};

/// Whether a drive frame may go to a motor that may be of another model: it does not answer.
///
/// A DDSM115 reads the tenths of rpm of the models with separate frames as rpm, and the limits do not hold. Those read
/// its rpm as tenths, so nothing is faster than it was checked for. A zero has no unit.
pub(super) fn check_model_known(
    model: Model,
    effect: RawEffect,
    id: MotorId,
) -> Result<(), Refusal> {
    match effect {
        RawEffect::Drive { value, .. } if value != 0 && model.has_separate_frames() => {
            Err(Refusal::NotAnswering(id))
        }
        _ => Ok(()),
    }
}

/// Whether a raw frame with this effect may go to a motor now.
pub(super) fn check_raw(
    model: Model,
    effect: RawEffect,
    id: MotorId,
    known: Known,
    speed: Option<Rpm>,
    limits: Limits,
    consent: Consent,
) -> Result<(), Refusal> {
    let value = match effect {
        RawEffect::Drive { value, .. } => value,
        RawEffect::Switch(Mode::Position) => return check_position_switch(id, speed),
        RawEffect::Probe
        | RawEffect::Switch(_)
        | RawEffect::MayBeSwitch(_)
        | RawEffect::SetId
        | RawEffect::Unknown => return Ok(()),
    };
    if let Some(exceeded) = limits.too_hot(known.temperature) {
        return Err(Refusal::TooHot { id, exceeded });
    }
    check_raw_speed(effect, known, limits)?;
    if matches!(known.reported, None | Some(Mode::Current)) {
        // -32768 has no positive counterpart.
        let asked = model.current_of_raw(value.max(-i16::MAX));
        let raw = units::current(asked).raw();
        let current = CurrentTarget::new(raw.into()).unwrap_or_default();
        let asks = needs_consent(Setpoint::Current(current)) != Consent::None;
        if asks && consent == Consent::None {
            return Err(Refusal::NeedsConsent(current));
        }
    }
    Ok(())
}

/// Whether a raw drive value is within the speed limit. If the motor's loop is unknown, the value
/// may be a speed, and a motor clamps a larger value to its highest speed.
pub(super) fn check_raw_speed(
    effect: RawEffect,
    known: Known,
    limits: Limits,
) -> Result<(), Refusal> {
    let RawEffect::Drive { rpm, .. } = effect else {
        return Ok(());
    };
    let may_be_speed = matches!(known.reported, None | Some(Mode::Velocity));
    if may_be_speed && rpm > limits.speed_rpm() {
        return Err(Refusal::AboveSpeedLimit(limits.speed_rpm()));
    }
    Ok(())
}
