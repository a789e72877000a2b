//! The extreme of a noisy, rounded signal.

use super::{Point, crossing::first_reaching, least_squares::LeastSquares};

/// A peak begins at this part of its height.
const NEAR: f64 = 0.9;

/// The highest value and its time; `None` without points.
///
/// The highest report is too high by the noise, and off by half a step of the report. So a parabola is fitted to the
/// replies round it, for a quarter of the time since 90 % of its height to each side: a wider part is not symmetric. If the parabola has no top there,
/// the signal does not turn round, and the fit at the highest report counts.
pub(super) fn highest(points: &[Point]) -> Option<Point> {
    let value = points.iter().map(|point| point.value).reduce(f64::max)?;
    let place = points.iter().position(|point| point.value >= value)?;
    let run = points.get(place..)?.iter();
    let run = run.take_while(|point| point.value >= value);
    let first_s = points.get(place)?.t_s;
    let top = Point::new(f64::midpoint(first_s, run.last()?.t_s), value);
    let half_s = first_reaching(points, NEAR * value).map_or(0.0, |at_s| (top.t_s - at_s) / 4.0);
    let mut rows = LeastSquares::<3>::new();
    for point in points {
        let t_s = point.t_s - top.t_s;
        if t_s.abs() <= half_s {
            rows.add([1.0, t_s, t_s * t_s], point.value);
        }
    }
    let Some(fit) = rows.solve() else {
        return Some(top);
    };
    let [level, slope, bend] = fit.unknowns;
    let turns_s = -slope / (2.0 * bend);
    if bend < 0.0 && turns_s.abs() <= half_s {
        return Some(Point::new(top.t_s + turns_s, level + slope * turns_s / 2.0));
    }
    Some(Point::new(top.t_s, level))
}
