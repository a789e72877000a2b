//! How the wanted speed moves to the commanded one.

use crate::physics::STEP_S;

/// The way down, which acceleration does not touch: with [`LAG_S`], 120 rpm end in 370 ms.
const FALL_RPM_PER_S: f64 = 1050.0;
/// First-order lag of the measured response: the "plus 60 ms" of every spin-up.
const LAG_S: f64 = 0.058;
/// The ramp waits when it is this far ahead of the wheel. An unloaded wheel follows within 16 rpm,
/// so only a blocked or overloaded one makes it wait.
const LEAD_MAX_RPM: f64 = 40.0;

/// Ramp, then lag.
#[derive(Clone, Debug)]
pub(crate) struct SpeedProfile {
    ramp_rpm: f64,
    wanted_rpm: f64,
}

impl SpeedProfile {
    /// Starts from the speed that the wheel has.
    pub(crate) const fn from(actual_rpm: f64) -> Self {
        Self {
            ramp_rpm: actual_rpm,
            wanted_rpm: actual_rpm,
        }
    }

    /// One step towards the target; gives the speed to hold now. `rise_s_per_rpm`: seconds per rpm on the
    /// way up.
    pub(crate) fn step(&mut self, target_rpm: f64, rise_s_per_rpm: f64, actual_rpm: f64) -> f64 {
        self.ramp_rpm = self.ramp(target_rpm, rise_s_per_rpm, actual_rpm);
        self.wanted_rpm += (self.ramp_rpm - self.wanted_rpm) * STEP_S / LAG_S;
        self.wanted_rpm
    }

    fn ramp(&self, target_rpm: f64, rise_s_per_rpm: f64, actual_rpm: f64) -> f64 {
        let reverses = target_rpm * self.ramp_rpm < 0.0;
        if reverses || target_rpm.abs() < self.ramp_rpm.abs() {
            let goal_rpm = if reverses { 0.0 } else { target_rpm };
            return towards(self.ramp_rpm, goal_rpm, FALL_RPM_PER_S * STEP_S);
        }
        let lead_rpm = (self.ramp_rpm - actual_rpm) * target_rpm.signum();
        if lead_rpm > LEAD_MAX_RPM {
            return self.ramp_rpm;
        }
        towards(self.ramp_rpm, target_rpm, STEP_S / rise_s_per_rpm)
    }
}

/// `from`, moved towards `goal` by at most `by`.
pub(crate) fn towards(from: f64, goal: f64, by: f64) -> f64 {
    from + (goal - from).max(-by).min(by)
}
