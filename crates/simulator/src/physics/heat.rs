//! Winding temperature.

use std::time::Duration;

/// Warmer than the air by this for each watt. Chosen so that the rated current (9.5 W) settles below
/// the protection and a stalled motor (44 W) would not.
const KELVIN_PER_W: f64 = 4.0;
/// Time constant: minutes, as for any half a kilogram of copper and iron.
const TIME_CONSTANT_S: f64 = 300.0;
/// Heat is slow, so it goes in steps of this, on a grid like the rest.
pub(crate) const HEAT_STEP: Duration = Duration::from_millis(100);
const HEAT_STEP_S: f64 = 0.1;

/// The winding and the air round it.
#[derive(Clone, Debug)]
pub(crate) struct Heat {
    winding_c: f64,
    ambient_c: f64,
    /// Energy since the last heat step.
    pending_j: f64,
}

impl Heat {
    /// Step of the slow grid on which [`Heat::settle`] is to be called.
    pub(crate) const STEP: Duration = HEAT_STEP;

    pub(crate) const fn at(ambient_c: f64) -> Self {
        Self {
            winding_c: ambient_c,
            ambient_c,
            pending_j: 0.0,
        }
    }

    pub(crate) const fn winding_c(&self) -> f64 {
        self.winding_c
    }

    pub(crate) const fn set_winding_c(&mut self, celsius: f64) {
        self.winding_c = celsius;
    }

    pub(crate) const fn set_ambient_c(&mut self, celsius: f64) {
        self.ambient_c = celsius;
    }

    pub(crate) const fn add_j(&mut self, joules: f64) {
        self.pending_j += joules;
    }

    /// One heat step.
    pub(crate) fn settle(&mut self) {
        let watts = self.pending_j / HEAT_STEP_S;
        self.pending_j = 0.0;
        let goal_c = self.ambient_c + watts * KELVIN_PER_W;
        self.winding_c += (goal_c - self.winding_c) * HEAT_STEP_S / TIME_CONSTANT_S;
    }
}
