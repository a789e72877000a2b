//! Between the units of the bus and those of the frames.
//!
//! The bus, the page and the recording have one set of units for every model: rpm, and raw current of 8 A at full
//! scale. Only here the units of a model matter.

use motorlink_protocol::{
    Current, CurrentTarget, Drive, Mode, Rpm,
    family::{self, Model, Speed},
};

/// A drive frame of this model in the units of the bus, if the motor reads it in this loop.
pub(crate) fn in_bus_units(model: Model, drive: Drive, mode: Mode) -> Drive {
    let raw = drive.signed();
    let value = match mode {
        Mode::Velocity => speed(model.speed_of_raw(raw)).rpm().to_be_bytes(),
        Mode::Current => current(model.current_of_raw(raw)).raw().to_be_bytes(),
        Mode::Position | Mode::OpenLoop => drive.value,
    };
    Drive { value, ..drive }
}

/// A reported current. It is an upper bound if its scale is not certain.
pub(crate) fn current(reported: family::Current) -> Current {
    let full_scale = i32::from(reported.scale().milliamps());
    Current::from_raw(saturated(
        i32::from(reported.raw()) * full_scale / CurrentTarget::FULL_SCALE_MA,
    ))
}

/// A reported speed, rounded towards zero: 0 is less than 1 rpm.
pub(crate) fn speed(reported: Speed) -> Rpm {
    Rpm::new(saturated(reported.tenths() / 10))
}

/// The speed that a drive value may ask for, in whole rpm, rounded up.
pub(crate) fn rpm_of_raw(model: Model, value: i16) -> u16 {
    let tenths = model.speed_of_raw(value).tenths().unsigned_abs();
    u16::try_from(tenths.div_ceil(10)).unwrap_or(u16::MAX)
}

fn saturated(value: i32) -> i16 {
    i16::try_from(value).unwrap_or(if value < 0 { -i16::MAX } else { i16::MAX })
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{CurrentTarget, Setpoint, SpeedTarget};

    use super::*;

    #[test]
    fn a_ddsm115_takes_the_units_of_the_bus() {
        for setpoint in [
            Setpoint::velocity(SpeedTarget::new(-330).unwrap()),
            Setpoint::Current(CurrentTarget::new(-12_345).unwrap()),
            Setpoint::Brake,
        ] {
            assert_eq!(setpoint.drive(Model::Ddsm115), Drive::from(setpoint));
            assert_eq!(setpoint.drive(Model::Ddsm315), Drive::from(setpoint));
        }
    }

    #[test]
    fn speeds_of_the_others_are_in_tenths() {
        let setpoint = Setpoint::velocity(SpeedTarget::new(-100).unwrap());
        for model in [Model::Ddsm210, Model::Ddsm400] {
            assert_eq!(setpoint.drive(model).signed(), -1_000);
            assert_eq!(speed(model.speed_of_raw(-999)), Rpm::new(-99));
            assert_eq!(rpm_of_raw(model, -991), 100);
        }
    }

    #[test]
    fn full_scale_of_a_ddsm400_is_four_amps() {
        let half = Setpoint::Current(CurrentTarget::from_amps(-2.0));
        let raw = half.drive(Model::Ddsm400).signed();
        assert!((-16_384..=-16_382).contains(&raw), "{raw}");
        let too_much = Setpoint::Current(CurrentTarget::from_amps(5.0));
        assert_eq!(too_much.drive(Model::Ddsm400).signed(), i16::MAX);
        let reported = current(Model::Ddsm400.current_of_amps(-2.0));
        assert!((reported.amps() + 2.0).abs() < 0.001, "{reported}");
    }
}
