//! What a motor reports.

use std::collections::BTreeMap;

use motorlink_bus::{Mirror, Sample};
use motorlink_protocol::{Celsius, Detail, Instant, MotorId, family::Model};
use pyo3::prelude::*;

/// A motor is asked for its temperature less often than for its speed.
const TEMPERATURE_FRESH_S: f64 = 2.0;

/// What a motor reports at one moment. A value that the motor has not told is `None`.
#[pyclass(frozen, get_all)]
#[derive(Clone, Debug)]
pub struct Reading {
    /// Seconds since the line was opened.
    time_s: f64,
    /// Its ID.
    motor: u8,
    /// The loop it closes: open loop, current, velocity or position.
    mode: String,
    /// Speed in rpm, with the sign of its side.
    speed_rpm: Option<i16>,
    /// Torque current in A, with the sign of its side. `None` if its scale is not known.
    current_a: Option<f32>,
    /// Torque current as the number in the reply, with the sign of the wire.
    current_raw: Option<i16>,
    /// Angle in degrees, 0 to 360, as the motor counts it.
    angle_deg: Option<f32>,
    /// Temperature of the winding in deg C, at most two seconds old.
    temperature_c: Option<u8>,
    /// Active faults; empty if there are none.
    faults: String,
}

#[pymethods]
impl Reading {
    fn __repr__(&self) -> String {
        let number = |value: Option<f64>, unit: &str| match value {
            Some(value) => format!("{} {unit}", (value * 1e3).round() / 1e3),
            None => format!("- {unit}"),
        };
        format!(
            "<Reading {:.3} s, motor {}: {}, {}, {}, {}>",
            self.time_s,
            self.motor,
            number(self.speed_rpm.map(f64::from), "rpm"),
            number(self.current_a.map(f64::from), "A"),
            number(self.angle_deg.map(f64::from), "deg"),
            number(self.temperature_c.map(f64::from), "°C"),
        )
    }
}

/// Makes readings of replies.
#[derive(Debug, Default)]
pub struct Readings {
    temperatures: BTreeMap<MotorId, (f64, Celsius)>,
}

impl Readings {
    pub fn of(
        &mut self,
        model: Model,
        sample: &Sample,
        mirror: Mirror,
        opened: Instant,
    ) -> Reading {
        let reply = &sample.reply;
        let time_s = sample.at.since(opened).as_secs_f64();
        let (angle_deg, celsius) = match reply.detail {
            Detail::Drive { position } | Detail::Odometry { position, .. } => {
                (Some(position.degrees()), None)
            }
            Detail::Query {
                temperature,
                position,
            } => (Some(position.degrees()), Some(temperature)),
            Detail::Temperature(celsius) => (None, Some(celsius)),
            Detail::Undetermined(_) => (None, None),
        };
        if let Some(celsius) = celsius {
            self.temperatures.insert(reply.id, (time_s, celsius));
        }
        let known = self.temperatures.get(&reply.id);
        let fresh = known.filter(|(at_s, _)| time_s - at_s <= TEMPERATURE_FRESH_S);
        let is_certain = model.spec().current.is_certain();
        let amps = reply.current.filter(|_| is_certain);
        Reading {
            time_s,
            motor: reply.id.get(),
            mode: reply.mode.to_string(),
            speed_rpm: reply.speed.map(|speed| mirror.speed(speed).rpm()),
            current_a: amps.map(|current| mirror.current(current).amps()),
            current_raw: reply.current.map(motorlink_protocol::Current::raw),
            angle_deg,
            temperature_c: fresh.map(|(_, celsius)| celsius.degrees()),
            faults: if reply.faults.is_none() {
                String::new()
            } else {
                reply.faults.to_string()
            },
        }
    }
}
