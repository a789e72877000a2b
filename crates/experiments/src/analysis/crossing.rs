//! Finds when a reported signal crosses a level.

use super::Point;

/// The points at which a rounded signal is known best.
///
/// A motor reports whole rpm. When the report changes from one number to the next, the true value is halfway between
/// them, to within the time between two replies. Between changes it is only known to half a unit. So the result is
/// the middle of every change, and the first and last point.
pub(super) fn changes(points: &[Point]) -> Vec<Point> {
    let pairs = points.iter().zip(points.iter().skip(1));
    let middles = pairs.filter(|(one, next)| {
        // Equal reports have equal bits.
        one.value.to_bits() != next.value.to_bits()
    });
    let middles = middles.map(|(one, next)| Point {
        t_s: f64::midpoint(one.t_s, next.t_s),
        value: f64::midpoint(one.value, next.value),
    });
    let first = points.first().copied();
    let last = points.last().copied();
    first.into_iter().chain(middles).chain(last).collect()
}

/// The first time at which lines between the points reach `level`, from below. The first point may have reached it.
pub(super) fn first_reaching(points: &[Point], level: f64) -> Option<f64> {
    let place = points.iter().position(|point| point.value >= level)?;
    let reached = points.get(place)?;
    let before = place.checked_sub(1).and_then(|before| points.get(before));
    Some(before.map_or(reached.t_s, |before| between(*before, *reached, level)))
}

/// The last time at which lines between the points deviate more than `off` from `level`.
pub(super) fn last_outside(points: &[Point], level: f64, off: f64) -> Option<f64> {
    let outside = |point: &Point| (point.value - level).abs() > off;
    let place = points.iter().rposition(outside)?;
    let out = points.get(place)?;
    let Some(next) = points.get(place + 1) else {
        return Some(out.t_s);
    };
    let edge = level + off * (out.value - level).signum();
    Some(between(*out, *next, edge))
}

fn between(one: Point, next: Point, level: f64) -> f64 {
    let part = (level - one.value) / (next.value - one.value);
    one.t_s + (next.t_s - one.t_s) * part
}
