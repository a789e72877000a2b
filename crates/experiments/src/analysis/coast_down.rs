//! Coast-down: the friction of a wheel without drive.

use super::{
    Point, RAD_S_PER_RPM, crossing::changes, least_squares::LeastSquares, statistics::Estimate,
};

/// Below this speed a wheel can rock or stand still, and the friction model does not apply.
const ROLLS_RPM: f64 = 3.0;

/// Friction divided by inertia, from wheels that coast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoastDown {
    /// Dry (Coulomb) friction divided by inertia, in rad/s2.
    pub dry_rad_s2: Estimate,
    /// Viscous friction divided by inertia, in 1/s.
    pub viscous_per_s: Estimate,
}

/// Fits `J dw/dt = -dry - viscous w` to wheels that coast in either direction.
///
/// Each run is the reported speed in rpm while nothing drives the wheel. The equation is fitted in its integrated
/// form, `w = w0 - (dry / J) t - (viscous / J) angle`, so that no speed is differentiated. Each run has its own `w0`;
/// subtracting the means removes it. `None` without a run that slows down.
#[must_use]
pub fn coast_down(runs: &[&[Point]]) -> Option<CoastDown> {
    let runs: Vec<Vec<Row>> = runs.iter().map(|run| rows_of(run)).collect();
    // The speed is exact and the time of its change is not, so points at a high deceleration are less certain. A
    // first fit gives the deceleration.
    let first = fit(&runs, |_| 1.0)?;
    let slows = |w: f64| first.dry_rad_s2.value + first.viscous_per_s.value * w;
    fit(&runs, |w| 1.0 / slows(w).max(f64::EPSILON))
}

fn fit(runs: &[Vec<Row>], weight: impl Fn(f64) -> f64) -> Option<CoastDown> {
    let mut rows = LeastSquares::<2>::new();
    for run in runs {
        let total: f64 = run.iter().map(|row| weight(row.w).powi(2)).sum();
        let mean = |part: fn(&Row) -> f64| {
            let parts = run.iter().map(|row| weight(row.w).powi(2) * part(row));
            parts.sum::<f64>() / total
        };
        let (w, t_s, angle) = (
            mean(|row| row.w),
            mean(|row| row.t_s),
            mean(|row| row.angle),
        );
        for row in run {
            let weight = weight(row.w);
            let unknowns = [t_s - row.t_s, angle - row.angle].map(|it| it * weight);
            rows.add(unknowns, (row.w - w) * weight);
        }
    }
    let [dry_rad_s2, viscous_per_s] = Estimate::of(&rows.solve()?);
    Some(CoastDown {
        dry_rad_s2,
        viscous_per_s,
    })
}

struct Row {
    t_s: f64,
    /// Speed without direction, in rad/s.
    w: f64,
    /// Angle since the start, in rad.
    angle: f64,
}

fn rows_of(run: &[Point]) -> Vec<Row> {
    let rolling = |point: &&Point| point.value.abs() >= ROLLS_RPM;
    let rolling: Vec<Point> = run.iter().take_while(rolling).copied().collect();
    let known = changes(&rolling);
    let mut rows: Vec<Row> = Vec::new();
    // The first and last point are not changes: their speed is only known to half an rpm.
    let inner = known.len().saturating_sub(2);
    for point in known.iter().skip(1).take(inner) {
        let w = point.value.abs() * RAD_S_PER_RPM;
        let angle = rows.last().map_or(0.0, |before| {
            before.angle + (point.t_s - before.t_s) * f64::midpoint(before.w, w)
        });
        rows.push(Row {
            t_s: point.t_s,
            w,
            angle,
        });
    }
    rows
}
