//! Inertia, from the acceleration by a known torque.

use super::{
    CoastDown, Point, RAD_S_PER_RPM,
    crossing::changes,
    least_squares::LeastSquares,
    statistics::{Estimate, mean},
};

/// Minimal number of pushes: their spread gives the confidence.
const PUSHES_MIN: u32 = 4;

/// A wheel under a constant torque of the current loop.
#[derive(Clone, Copy, Debug)]
pub struct Push<'a> {
    /// The commanded current times the torque per ampere, in N.m.
    pub torque_nm: f64,
    /// The reported speed in rpm, from the start of the torque.
    pub speed: &'a [Point],
}

/// Inertia, and friction as torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Inertia of all turning parts, in kg.m2.
    pub inertia_kg_m2: Estimate,
    /// Dry friction in N.m.
    pub dry_nm: Estimate,
    /// Viscous friction in N.m per rad/s.
    pub viscous_nm_s: Estimate,
}

/// Fits `J dw/dt = torque - friction` to pushes, with the friction of a coast-down.
///
/// `None` for fewer than four pushes with a slope.
#[must_use]
pub fn inertia(pushes: &[Push<'_>], coast: &CoastDown) -> Option<Inertia> {
    let found: Vec<f64> = pushes
        .iter()
        .filter_map(|push| one_over_j(push, coast))
        .collect();
    let count = u32::try_from(found.len()).ok()?;
    if count < PUSHES_MIN {
        return None;
    }
    let middle = mean(found.iter().copied())?;
    let freedom = f64::from(count - 1);
    let squares: f64 = found.iter().map(|one| (one - middle).powi(2)).sum();
    let error = (squares / freedom / f64::from(count)).sqrt();
    let inertia_kg_m2 = Estimate::by_error(middle, error, freedom).inverse();
    Some(Inertia {
        inertia_kg_m2,
        dry_nm: coast.dry_rad_s2.product(inertia_kg_m2),
        viscous_nm_s: coast.viscous_per_s.product(inertia_kg_m2),
    })
}

/// The slope of the speed per N.m, corrected for friction.
fn one_over_j(push: &Push<'_>, coast: &CoastDown) -> Option<f64> {
    let known = changes(push.speed);
    let mut rows = LeastSquares::<2>::new();
    let mut before: Option<(f64, f64)> = None;
    let mut lost = 0.0;
    let inner = known.len().saturating_sub(2);
    for point in known.iter().skip(1).take(inner) {
        let w = point.value * RAD_S_PER_RPM;
        if let Some((t_s, w_before)) = before {
            let w = f64::midpoint(w, w_before);
            let braked = w.signum() * coast.dry_rad_s2.value + w * coast.viscous_per_s.value;
            lost += braked * (point.t_s - t_s);
        }
        before = Some((point.t_s, w));
        rows.add([1.0, point.t_s], w + lost);
    }
    let [_, slope] = rows.solve()?.unknowns;
    let one_over_j = slope / push.torque_nm;
    (one_over_j.is_finite() && one_over_j > 0.0).then_some(one_over_j)
}
