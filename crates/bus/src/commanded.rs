//! What a recorded drive frame commands.

use motorlink_protocol::{
    Acceleration, Drive, Mode, MotorId, OpenLoopTarget, Position, Rpm, Setpoint,
    family::{Current, Model, Request},
};

use crate::{line_event::LineEventKind, model::units};

/// The value of a drive frame in its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandedValue {
    /// In the velocity loop.
    Speed(Rpm),
    /// In the current loop.
    Current(Current),
    /// In the position loop.
    Position(Position),
    /// Without a loop: a share of the supply.
    OpenLoop(OpenLoopTarget),
}

impl CommandedValue {
    /// What the value of a drive frame commands to a motor of this model in this loop.
    #[must_use]
    pub fn of(model: Model, drive: Drive, mode: Mode) -> Self {
        match mode {
            Mode::Velocity => Self::Speed(units::speed(model.speed_of_raw(drive.signed()))),
            Mode::Current => Self::Current(model.current_of_raw(drive.signed())),
            Mode::Position => Self::Position(Position::from_raw(drive.unsigned())),
            Mode::OpenLoop => Self::OpenLoop(OpenLoopTarget::nearest(drive.signed())),
        }
    }
}

/// The setpoint of a drive frame for a motor of this model that reads it in this loop.
#[must_use]
pub fn commanded_setpoint(model: Model, drive: Drive, mode: Mode) -> Setpoint {
    units::in_bus_units(model, drive, mode).setpoint(mode)
}

/// The motor that an event of a line commands, and its drive frame with the loop in which the motor reads it. There is none
/// after a mode switch, or if the loop is unknown. `None` for an event that commands nothing.
#[must_use]
pub fn commanded(model: Model, kind: &LineEventKind) -> Option<(MotorId, Option<(Drive, Mode)>)> {
    if let LineEventKind::Known { id, mode, value } = *kind {
        let drive = value.map(|value| Drive {
            value,
            acceleration: Acceleration::DEFAULT,
            brake: 0,
        });
        return Some((id, drive.zip(Some(mode))));
    }
    let (frame, mode) = kind.sent()?;
    match Request::parse(model, &frame).ok()? {
        Request::Drive { id, drive } => Some((id, Some(drive).zip(mode))),
        // The value before it was for another loop.
        Request::SwitchMode { id, .. } => Some((id, None)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_has_the_unit_of_its_model_and_its_loop() {
        let drive = |value: i16| Drive {
            value: value.to_be_bytes(),
            ..Drive::from(Setpoint::Brake)
        };
        let of = |model, mode| CommandedValue::of(model, drive(500), mode);
        for (model, rpm) in [
            (Model::Ddsm115, 500),
            (Model::Ddsm210, 50),
            (Model::Ddsm400, 50),
        ] {
            assert_eq!(
                of(model, Mode::Velocity),
                CommandedValue::Speed(Rpm::new(rpm))
            );
        }
        let amps = |model| match of(model, Mode::Current) {
            CommandedValue::Current(current) => current.amps(),
            other => panic!("{other:?}"),
        };
        assert!((amps(Model::Ddsm115) - 0.122_074).abs() < 1e-5);
        assert!((amps(Model::Ddsm400) - 0.061_037).abs() < 1e-5);
        let position = CommandedValue::Position(Position::from_raw(500));
        assert_eq!(of(Model::Ddsm210, Mode::Position), position);
        let share = CommandedValue::OpenLoop(OpenLoopTarget::nearest(500));
        assert_eq!(of(Model::Ddsm400, Mode::OpenLoop), share);
    }
}
