//! Friction by speed and current.

use super::{
    Point,
    least_squares::LeastSquares,
    statistics::{Estimate, mean},
};

/// Below this speed the direction of dry friction is uncertain.
const TURNS_RPM: f64 = 2.0;

/// The current that a motor needs to keep its speed without load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// The part that does not depend on speed (Coulomb), in A.
    pub coulomb_a: Estimate,
    /// The part that grows with speed (viscous), in A per rpm.
    pub viscous_a_per_rpm: Estimate,
}

/// A speed that is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLevel {
    /// Mean speed in rpm.
    pub rpm: f64,
    /// Mean current in A.
    pub amps: f64,
}

impl SpeedLevel {
    /// The means from `settle_s` after the first reply on; `None` without replies.
    #[must_use]
    pub fn of(speed: &[Point], amps: &[Point], settle_s: f64) -> Option<Self> {
        let from_s = speed.first()?.t_s + settle_s;
        let settled = |signal: &[Point]| {
            let settled = signal.iter().filter(|point| point.t_s >= from_s);
            mean(settled.map(|point| point.value))
        };
        Some(Self {
            rpm: settled(speed)?,
            amps: settled(amps)?,
        })
    }
}

/// Fits `current = coulomb * sign(speed) + viscous * speed` to the means at several speeds.
///
/// Each speed counts as one value: its replies have correlated noise, and seconds later the noise is independent. `None`
/// for fewer than three speeds.
#[must_use]
pub fn friction(levels: &[SpeedLevel]) -> Option<Friction> {
    let mut rows = LeastSquares::<2>::new();
    for level in levels.iter().filter(|level| level.rpm.abs() >= TURNS_RPM) {
        rows.add([level.rpm.signum(), level.rpm], level.amps);
    }
    let [coulomb_a, viscous_a_per_rpm] = Estimate::of(&rows.solve()?);
    Some(Friction {
        coulomb_a,
        viscous_a_per_rpm,
    })
}
