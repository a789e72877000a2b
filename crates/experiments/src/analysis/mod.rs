//! Computes figures from samples. Every function is pure.
//!
//! `docs/experiments.md` explains each figure and the source of its formula.

mod batch_means;
mod coast_down;
mod crossing;
mod fitted_model;
mod frequency;
mod friction;
mod heating;
mod inertia;
mod least_squares;
mod peak;
mod setpoint_rate;
mod silence;
mod statistics;
mod steady;
mod step_response;
mod torque_speed;
mod trace;
mod tracking;

pub use coast_down::{CoastDown, coast_down};
pub use fitted_model::{FittedModel, Lag, bode_model, step_model};
pub use frequency::{BodePoint, Invalid, SineRun, bandwidth_hz, frequency_point, unwrap_phases};
pub use friction::{Friction, SpeedLevel, friction};
pub use heating::{Heating, heating};
pub use inertia::{Inertia, Push, inertia};
pub use setpoint_rate::{SetpointRate, setpoint_rate};
pub use silence::{Silence, WhenSilent};
pub(crate) use silence::{keeps, median};
pub use statistics::{CONFIDENCE, Estimate, Spread, spread};
pub use step_response::{StepFigures, StepRun, StepSummary, step_figures, step_summary};
pub use torque_speed::{CurrentBySpeed, Droop, TorqueSpeed, torque_speed};
pub use trace::Trace;
pub use tracking::{Tracking, tracking};

/// Torque of one ampere, in N.m (the maker's figure for M0601 and DDSM115).
pub const TORQUE_NM_PER_A: f64 = 0.75;

/// The smallest difference of speed that a sample can show, in rpm.
pub const RPM_RESOLUTION: f64 = 1.0;

/// rad/s of one rpm.
const RAD_S_PER_RPM: f64 = std::f64::consts::TAU / 60.0;

/// A value at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Seconds since the start of the run.
    pub t_s: f64,
    /// The value, in the unit of its quantity.
    pub value: f64,
}

impl Point {
    /// A value at a time.
    #[must_use]
    pub const fn new(t_s: f64, value: f64) -> Self {
        Self { t_s, value }
    }
}
