//! What a recorded drive frame commands.

use motorlink_protocol::{
    Drive, Frame, Mode, MotorId, OpenLoopTarget, Position, Rpm, Setpoint,
    family::{Current, Model, Request},
};

use crate::model::units;

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

/// The motor and the setpoint of a drive frame of this model, if the motor reads it in this loop; `None` for other frames.
#[must_use]
pub fn commanded_setpoint(model: Model, frame: &Frame, mode: Mode) -> Option<(MotorId, Setpoint)> {
    match Request::parse(model, frame) {
        Ok(Request::Drive { id, drive }) => {
            let drive = units::in_bus_units(model, drive, mode);
            Some((id, drive.setpoint(mode)))
        }
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
