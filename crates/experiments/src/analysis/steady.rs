//! The steady value after a step, and whether there is one.

use super::{Point, Trace, crossing::last_outside, least_squares::LeastSquares, statistics::mean};

/// Settled means within this band, as a part of the way.
pub(super) const SETTLED: f64 = 0.02;
/// The steady value is the mean over this last part of the time.
const TAIL: f64 = 0.25;
/// Maximal trend over the tail, as a part of the way. With more, the time at which a slow system enters the band would
/// be off by over 1 %.
pub(super) const TREND_MAX: f64 = 0.0005;
/// The trend of a ramp over the tail is 0.29 of its way to the mean of the tail. So a trend above this part may be one.
const RAMP: f64 = 0.2;

/// The value that a step has settled at; `None` if it has not.
///
/// It has settled if it stays within the band before the tail begins, and neither a trend nor a swing is left within
/// it. A report that changes by one step hides a trend of one step, so a way of less than five steps may be a ramp, and
/// has not settled. `start` is the value before the step; `known` has the changes of the response.
pub(super) fn steady_value(
    start: Point,
    response: &[Point],
    known: &[Point],
    resolution: f64,
) -> Option<f64> {
    let ends_s = response.last()?.t_s;
    let long_s = (ends_s - start.t_s) * TAIL;
    let tail = Trace::between(response, ends_s - long_s, f64::INFINITY);
    let steady = mean(tail.iter().map(|point| point.value))?;
    let mut rows = LeastSquares::<2>::new();
    for point in tail {
        rows.add([1.0, point.t_s - ends_s], point.value);
    }
    let [_, slope] = rows.solve()?.unknowns;
    let trend = (slope * long_s).abs();
    let way = (steady - start.value).abs();
    // A swing that turns within the tail has no trend, but its thirds differ.
    let third = |from: f64| {
        let from_s = ends_s - long_s * from;
        let points = Trace::between(tail, from_s, from_s + long_s / 3.0);
        mean(points.iter().map(|point| point.value))
    };
    let thirds = [third(1.0)?, third(2.0 / 3.0)?, third(1.0 / 3.0)?];
    let spread = thirds.into_iter().fold(f64::NEG_INFINITY, f64::max)
        - thirds.into_iter().fold(f64::INFINITY, f64::min);
    let has_trend = trend.max(spread) > (TREND_MAX * way).max(resolution);
    let may_be_ramp = trend + resolution > RAMP * way;
    let band = (SETTLED * way).max(resolution);
    let leaves = last_outside(known, steady, band).is_some_and(|at_s| at_s >= ends_s - long_s);
    (!has_trend && !may_be_ramp && !leaves).then_some(steady)
}
