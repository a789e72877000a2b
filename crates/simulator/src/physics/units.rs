//! The time step and the units of the physics.

use std::{f64::consts::TAU, time::Duration};

/// Physics and firmware run in steps on a grid of this from the epoch, so that results do not depend
/// on how often anyone looks. A quarter of a millisecond is a fortieth of the speed loop's response.
pub(crate) const STEP: Duration = Duration::from_micros(250);
/// [`STEP`] in seconds.
pub(crate) const STEP_S: f64 = 250e-6;

/// rad/s of one rpm.
const RAD_S_PER_RPM: f64 = TAU / 60.0;

pub(crate) const fn rpm(rad_s: f64) -> f64 {
    rad_s / RAD_S_PER_RPM
}

pub(crate) const fn rad_s(rpm: f64) -> f64 {
    rpm * RAD_S_PER_RPM
}
