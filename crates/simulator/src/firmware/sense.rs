//! Measurements of the controller.

/// What the controller can measure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sense {
    pub(crate) speed_rad_s: f64,
    pub(crate) turns: f64,
    pub(crate) phase_a: f64,
    pub(crate) bus_a: f64,
    pub(crate) winding_c: f64,
    /// Torque current that voltage and limit allow now.
    pub(crate) range_a: (f64, f64),
    pub(crate) encoder_broken: bool,
}
