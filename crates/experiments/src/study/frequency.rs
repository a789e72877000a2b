//! The study of the frequency response of the velocity loop.

use std::f64::consts::TAU;

use motorlink_protocol::MotorId;

use super::{
    Measured, Parameter,
    spans::{follow, hold_rpm, ramp_rpm, spans},
};
use crate::{
    analysis::{
        BodePoint, FittedModel, RPM_RESOLUTION, SineRun, Trace, bandwidth_hz, bode_model,
        frequency_point, unwrap_phases,
    },
    runner::Record,
    sequence::{End, HZ_MAX, Problem, Quantity, RunLimits, Sequence, SequenceError, Shape, Wave},
};

/// Maximal rate of the setpoint, in rpm per second. The motor's own ramp is 277 rpm per second; it limits faster
/// setpoints.
const SLOPE_MAX: f64 = 200.0;
/// Minimal amplitude. The protocol has whole rpm.
const AMPLITUDE_MIN_RPM: f64 = 3.0;
/// The motor follows steadily after this time: ten time constants of its velocity loop.
const SETTLE_S: f64 = 0.6;
/// Minimal measured time of a point: enough replies to average out the rounding to 1 rpm.
const MEASURE_MIN_S: f64 = 6.0;
/// Minimal number of measured periods.
const PERIODS_MIN: f64 = 3.0;
/// Steps before the first sine.
const STEPS_BEFORE: usize = 2;

/// A sine at each of several frequencies.
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyStudy {
    /// The motor.
    pub motor: MotorId,
    /// The first frequency.
    pub lowest_hz: f64,
    /// The last frequency.
    pub highest_hz: f64,
    /// Number of frequencies, evenly per octave.
    pub points: u32,
    /// The deviation to each side at the lowest frequencies, in rpm. At higher ones it is smaller, because the motor
    /// limits how fast its speed grows.
    pub amplitude_rpm: f64,
    /// The speed in the middle, in rpm: away from standstill, where dry friction changes its sign.
    pub centre_rpm: f64,
}

/// The figures of a frequency response.
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyFindings {
    /// One for each measured frequency. Invalid points are marked.
    pub points: Vec<BodePoint>,
    /// Where the gain is 3 dB below that of the first point. See [`bandwidth_hz`].
    pub bandwidth_hz: Option<f64>,
    /// A model of the valid points.
    pub model: Option<FittedModel>,
    /// Frequencies that were paused. They have no point.
    pub left_out: usize,
}

impl FrequencyStudy {
    /// 0.2 to 20 Hz in 21 points, 20 rpm round 80 rpm.
    #[must_use]
    pub const fn of(motor: MotorId) -> Self {
        Self {
            motor,
            lowest_hz: 0.2,
            highest_hz: 20.0,
            points: 21,
            amplitude_rpm: 20.0,
            centre_rpm: 80.0,
        }
    }

    pub(super) fn parameters(&mut self) -> Vec<Parameter<'_>> {
        vec![
            Parameter::real("lowest_hz", &mut self.lowest_hz, 0.05, HZ_MAX),
            Parameter::real("highest_hz", &mut self.highest_hz, 0.05, HZ_MAX),
            Parameter::whole("points", &mut self.points, 2, 60),
            Parameter::real(
                "amplitude_rpm",
                &mut self.amplitude_rpm,
                AMPLITUDE_MIN_RPM,
                150.0,
            ),
            Parameter::real("centre_rpm", &mut self.centre_rpm, -330.0, 330.0),
        ]
    }

    pub(super) fn check(&self, rpm_max: f64) -> Result<(), SequenceError> {
        if self.highest_hz <= self.lowest_hz {
            let problem = Problem::Below {
                value: self.highest_hz,
                min: self.lowest_hz,
            };
            return Err(SequenceError::at("highest_hz", problem));
        }
        let value = self.centre_rpm.abs() + self.amplitude_rpm;
        if value > rpm_max {
            let problem = Problem::Above {
                value,
                max: rpm_max,
            };
            return Err(SequenceError::at("amplitude_rpm", problem));
        }
        Ok(())
    }

    /// The sines with their times.
    fn sines(&self) -> Vec<(Wave, f64)> {
        let last = self.points.saturating_sub(1).max(1);
        let ratio = self.highest_hz / self.lowest_hz;
        // Rounded, so that a file has 0.252 instead of sixteen digits.
        let short = |value: f64| (value * 1000.0).round() / 1000.0;
        let sine = |point: u32| {
            let hz = short(self.lowest_hz * ratio.powf(f64::from(point) / f64::from(last)));
            let amplitude = (SLOPE_MAX / (TAU * hz)).max(AMPLITUDE_MIN_RPM);
            let wave = Wave {
                centre: self.centre_rpm,
                amplitude: (amplitude.min(self.amplitude_rpm) * 10.0).round() / 10.0,
                hz,
            };
            let measure_s = MEASURE_MIN_S.max(PERIODS_MIN / hz);
            // Whole periods, so that a sine ends where the next one begins.
            let periods = ((SETTLE_S + measure_s) * hz).ceil();
            (wave, periods / hz)
        };
        (0..self.points).map(sine).collect()
    }

    pub(super) fn sequence(&self) -> Sequence {
        let centre = self.centre_rpm;
        let mut steps = vec![
            ramp_rpm(self.motor, centre, 2.0),
            hold_rpm(self.motor, centre, 1.0),
        ];
        steps.extend(self.sines().into_iter().map(|(wave, for_s)| {
            let end = End::After(for_s);
            follow(self.motor, Quantity::Rpm, Shape::Sine(wave), end)
        }));
        steps.push(ramp_rpm(self.motor, 0.0, 2.0));
        Sequence {
            name: "Frequency response".to_owned(),
            limits: RunLimits::default(),
            steps,
        }
    }

    pub(super) fn evaluate(&self, record: &Record, measured: &Measured) -> FrequencyFindings {
        let trace = Trace::with_airtime(record, self.motor, measured.airtime);
        let request_hz = trace.request_hz(measured.request_hz);
        let sines = self.sines();
        let mut found = FrequencyFindings {
            points: Vec::new(),
            bandwidth_hz: None,
            model: None,
            left_out: 0,
        };
        for span in spans(record).into_iter().filter(|span| !span.is_running) {
            let place = span.step.checked_sub(STEPS_BEFORE);
            let Some((wave, for_s)) = place.and_then(|place| sines.get(place)) else {
                continue;
            };
            // An aborted sine is marked as too short; a paused one is none.
            if !span.lasted(*for_s) && span.to_s - span.from_s > *for_s {
                found.left_out += 1;
                continue;
            }
            found.points.push(frequency_point(&SineRun {
                hz: wave.hz,
                amplitude: wave.amplitude,
                from_s: span.from_s + SETTLE_S,
                to_s: span.to_s,
                command: &trace.command,
                response: &trace.rpm,
                amps: &trace.amps,
                amps_max: measured.amps_max,
                request_hz,
                resolution: RPM_RESOLUTION,
            }));
        }
        unwrap_phases(&mut found.points);
        found.bandwidth_hz = bandwidth_hz(&found.points);
        found.model = bode_model(&found.points);
        found
    }
}
