//! The values of a program, checked.

use motorlink_bus::{BusSettings, CommandRate, Limits, Mirror, Ramp};
use motorlink_command::library::{SignedId, amps_setpoint, degrees_setpoint, rpm_setpoint};
use motorlink_protocol::{MotorId, Setpoint};
use pyo3::prelude::*;

use crate::errors::{InvalidInput, exception};

pub fn invalid(error: impl std::fmt::Display) -> PyErr {
    InvalidInput::new_err(error.to_string())
}

pub fn id(number: u8) -> PyResult<MotorId> {
    MotorId::new(number).map_err(invalid)
}

pub fn signed((number, mirrored): (u8, bool)) -> PyResult<SignedId> {
    let mirror = if mirrored {
        Mirror::Mirrored
    } else {
        Mirror::Straight
    };
    Ok(SignedId {
        id: id(number)?,
        mirror,
    })
}

pub fn setpoint(quantity: &str, value: f64, acceleration: u8) -> PyResult<Setpoint> {
    if !value.is_finite() {
        return Err(InvalidInput::new_err("expected a finite number"));
    }
    #[allow(
        clippy::cast_possible_truncation,
        reason = "a cast saturates, and the range is checked"
    )]
    let made = match quantity {
        "rpm" => rpm_setpoint(value.round() as i32, acceleration),
        "amps" => amps_setpoint(value as f32),
        _ => degrees_setpoint(value as f32),
    };
    made.map_err(|failure| exception(&failure))
}

/// The setpoints a second, the ramp in rpm a second, and the limits in rpm, A and deg C.
pub type Settings = (u16, Option<u16>, (u16, f64, u16));

pub fn bus_settings((rate_hz, ramp, (rpm, amps, celsius)): Settings) -> PyResult<BusSettings> {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast saturates, and the range is checked"
    )]
    let milliamps = (amps * 1_000.0).round() as u16;
    Ok(BusSettings {
        rate: CommandRate::new(rate_hz).map_err(invalid)?,
        ramp: ramp.map(Ramp::new).transpose().map_err(invalid)?,
        limits: Limits::new(rpm, milliamps, celsius).map_err(invalid)?,
        ..BusSettings::default()
    })
}
