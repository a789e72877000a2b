//! The controller that turns a speed error into current.

use crate::physics::STEP_S;

use super::sense::Sense;

/// Amps per rad/s of error: a response of 100 rad/s (10 ms) with the wheel's inertia and 0.75 N.m/A.
const GAIN_A_S: f64 = 0.133;
/// Amps per radian of accumulated error: a third of the response.
const INTEGRAL_A: f64 = 4.0;

/// Proportional and integral, limited to what voltage and firmware allow.
#[derive(Clone, Debug, Default)]
pub(crate) struct SpeedLoop {
    integral_a: f64,
}

impl SpeedLoop {
    /// One step; gives the torque current to drive. `gain` is that of the model.
    pub(crate) fn step(&mut self, wanted_rad_s: f64, sense: &Sense, gain: f64) -> f64 {
        let error = wanted_rad_s - sense.speed_rad_s;
        let (least, greatest) = sense.range_a;
        let amps = error * (GAIN_A_S * gain) + self.integral_a;
        let saturated = (amps > greatest && error > 0.0) || (amps < least && error < 0.0);
        if !saturated {
            self.integral_a += error * (INTEGRAL_A * gain) * STEP_S;
        }
        amps.max(least).min(greatest)
    }
}
