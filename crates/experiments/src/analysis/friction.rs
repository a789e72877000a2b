//! Friction by speed and current.

use super::{Point, least_squares::LeastSquares, statistics::Estimate};

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

/// Fits `current = coulomb * sign(speed) + viscous * speed`.
///
/// Each pair is one reply at a constant speed, as `(rpm, amps)`. `None` for fewer than two speeds.
#[must_use]
pub fn friction(replies: impl IntoIterator<Item = (f64, f64)>) -> Option<Friction> {
    let mut rows = LeastSquares::<2>::new();
    for (rpm, amps) in replies {
        if rpm.abs() >= TURNS_RPM {
            rows.add([rpm.signum(), rpm], amps);
        }
    }
    let [coulomb_a, viscous_a_per_rpm] = Estimate::of(&rows.solve()?);
    Some(Friction {
        coulomb_a,
        viscous_a_per_rpm,
    })
}

/// The replies at a constant setpoint, as input of [`friction`]: those from `settle_s` on.
#[must_use]
pub fn even_replies(speed: &[Point], amps: &[Point], settle_s: f64) -> Vec<(f64, f64)> {
    let from_s = speed.first().map_or(0.0, |first| first.t_s) + settle_s;
    let pairs = speed.iter().zip(amps);
    let settled = pairs.filter(|(speed, _)| speed.t_s >= from_s);
    settled
        .map(|(speed, amps)| (speed.value, amps.value))
        .collect()
}
