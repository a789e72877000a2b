//! Speed against torque, under an increasing load.

use super::{TORQUE_NM_PER_A, least_squares::LeastSquares, statistics::Estimate};

/// The linear relation of speed to torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueSpeed {
    /// Speed without torque, in rpm.
    pub no_load_rpm: Estimate,
    /// Decrease of speed per N.m, in rpm per N.m.
    pub droop_rpm_per_nm: Estimate,
    /// The largest measured torque, in N.m. The line is unknown beyond it.
    pub torque_max_nm: f64,
}

/// Fits `speed = no_load - droop * torque` to replies `(rpm, amps)` in one direction.
///
/// `None` if the torque hardly changed.
#[must_use]
pub fn torque_speed(replies: impl IntoIterator<Item = (f64, f64)>) -> Option<TorqueSpeed> {
    let mut rows = LeastSquares::<2>::new();
    let mut torque_max_nm = 0.0_f64;
    for (rpm, amps) in replies {
        let torque_nm = amps.abs() * TORQUE_NM_PER_A;
        torque_max_nm = torque_max_nm.max(torque_nm);
        rows.add([1.0, -torque_nm], rpm.abs());
    }
    let [no_load_rpm, droop_rpm_per_nm] = Estimate::of(&rows.solve()?);
    Some(TorqueSpeed {
        no_load_rpm,
        droop_rpm_per_nm,
        torque_max_nm,
    })
}
