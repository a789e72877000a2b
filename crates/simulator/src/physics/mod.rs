//! The wheel, its windings, their heat, and the encoder.
//!
//! SI units inside: rad/s, N.m, A, V, seconds. Only `+ - * /` and `sqrt`, so that native code and
//! wasm come to the same bits.

mod encoder;
mod heat;
mod units;
mod wheel;
mod winding;

pub(crate) use encoder::Encoder;
pub(crate) use heat::Heat;
pub(crate) use units::{STEP, STEP_S, rad_s, rpm};
pub(crate) use wheel::{DRY_FRICTION_NM, Push, VISCOUS_NM_S, Wheel};
pub(crate) use winding::{Bridge, Flow, Leak, Winding};
