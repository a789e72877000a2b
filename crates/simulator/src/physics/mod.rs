//! The wheel, its windings, their heat, and the encoder.
//!
//! SI units inside: rad/s, N.m, A, V, seconds. Only `+ - * /` and `sqrt`, so that native code and
//! wasm come to the same bits.

mod encoder;
mod heat;
mod wheel;
mod winding;

use std::{f64::consts::TAU, time::Duration};

pub(crate) use encoder::Encoder;
pub(crate) use heat::Heat;
pub(crate) use wheel::{DRY_FRICTION_NM, Push, VISCOUS_NM_S, Wheel};
pub(crate) use winding::{Bridge, CURRENT_LIMIT_A, Flow, Leak, Winding};

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
