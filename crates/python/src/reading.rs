//! What a motor reports.

use std::{collections::BTreeMap, time::Duration};

use motorlink_bus::{Mirror, Sample};
use motorlink_protocol::{Angle, Celsius, Instant, MotorId, family::Model};
use pyo3::prelude::*;

/// A motor is asked for its temperature less often than for its speed.
const TEMPERATURE_FRESH_FOR: Duration = Duration::from_secs(2);

/// What a motor reports at one moment. A value that the motor has not told is `None`.
#[pyclass(frozen, get_all)]
#[derive(Clone, Debug)]
pub struct Reading {
    /// Seconds since the line was opened.
    time_s: f64,
    /// Its ID.
    motor: u8,
    /// The loop it closes: open loop, current loop, velocity loop or position loop.
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

/// The last temperature of each motor.
#[derive(Debug, Default)]
pub struct Temperatures(BTreeMap<MotorId, (Instant, Celsius)>);

impl Temperatures {
    /// Notes the temperature of a reply, if it tells one.
    pub fn note(&mut self, sample: &Sample) {
        if let Some(celsius) = sample.reply.detail.temperature() {
            self.0.insert(sample.reply.id, (sample.at, celsius));
        }
    }

    /// The temperature of the motor when it sent this reply.
    pub fn fresh(&self, sample: &Sample) -> Option<Celsius> {
        let (at, celsius) = self.0.get(&sample.reply.id)?;
        (sample.at.since(*at) <= TEMPERATURE_FRESH_FOR).then_some(*celsius)
    }
}

impl Reading {
    /// What a reply tells, with the sign of this side.
    pub fn of(
        model: Model,
        sample: &Sample,
        mirror: Mirror,
        opened: Instant,
        celsius: Option<Celsius>,
    ) -> Self {
        let reply = &sample.reply;
        let angle_deg = reply.detail.angle().map(Angle::degrees);
        let is_certain = model.spec().current.is_certain();
        let amps = reply.current.filter(|_| is_certain);
        let faults = reply.faults;
        Self {
            time_s: sample.at.since(opened).as_secs_f64(),
            motor: reply.id.get(),
            mode: reply.mode.to_string(),
            speed_rpm: reply.speed.map(|speed| mirror.speed(speed).rpm()),
            current_a: amps.map(|current| mirror.current(current).amps()),
            current_raw: reply.current.map(motorlink_protocol::Current::raw),
            angle_deg,
            temperature_c: celsius.map(Celsius::degrees),
            faults: if faults.is_none() {
                String::new()
            } else {
                faults.to_string()
            },
        }
    }
}
