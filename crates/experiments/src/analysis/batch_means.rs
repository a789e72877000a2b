//! Least squares over means of batches: intervals that hold for correlated noise and for whole reports.
//!
//! Replies that follow each other have similar noise, so together they tell less than independent ones. The mean of a
//! batch that lasts much longer than this similarity is nearly independent of the next mean, and Student's interval holds
//! for the means (Schmeiser, Batch size effects in the analysis of simulation output, Operations Research 30, 1982: 10
//! to 30 batches).
//!
//! Without noise, all replies of one reported number have the same error, which no scatter shows. So this error is
//! counted once for each reported number, with the variance of a digital indication (GUM, F.2.2.1).

use super::{
    least_squares::{Fit, LeastSquares},
    statistics::Estimate,
};

/// Number of batches.
const BATCHES: usize = 15;
/// Minimal number of replies in a batch.
const REPLIES_MIN: usize = 4;
/// Variance of the error of a report in whole numbers.
const ROUNDING: f64 = 1.0 / 12.0;

/// A row of the equations from one reply.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reply<const N: usize> {
    pub(super) row: [f64; N],
    pub(super) y: f64,
    /// The whole number that was reported.
    pub(super) report: f64,
}

/// Fits the means of the batches; `None` for too few replies, or if they do not determine the unknowns.
pub(super) fn solve<const N: usize>(replies: &[Reply<N>]) -> Option<Fit<N>> {
    let mut rows = LeastSquares::new();
    for batch in batches(replies)? {
        let (row, y) = mean(batch);
        rows.add(row, y);
    }
    rows.solve()
}

/// The unknowns of [`solve`] with their intervals. `slope` is the error of the right side of a row for each unit by
/// which its report is off.
pub(super) fn estimates<const N: usize>(
    replies: &[Reply<N>],
    fit: &Fit<N>,
    slope: impl Fn(&Reply<N>) -> f64,
) -> Option<[Estimate; N]> {
    let mut parts: Vec<(f64, [f64; N])> = Vec::new();
    for batch in batches(replies)? {
        let influence = fit.influence(&mean(batch).0);
        let share = 1.0 / count(batch);
        for reply in batch {
            let turns = slope(reply) * share;
            let part = (reply.report, influence.map(|it| it * turns));
            // In the order of the reports.
            let place = parts.partition_point(|(report, _)| *report <= reply.report);
            parts.insert(place, part);
        }
    }
    let mut variances = fit.errors.map(|error| error * error);
    for same in parts.chunk_by(|one, next| one.0.total_cmp(&next.0).is_eq()) {
        for (at, variance) in variances.iter_mut().enumerate() {
            let off: f64 = same.iter().filter_map(|(_, part)| part.get(at)).sum();
            *variance += ROUNDING * off * off;
        }
    }
    let mut errors = variances.into_iter().map(f64::sqrt);
    Some(fit.unknowns.map(|value| {
        let error = errors.next().unwrap_or(f64::INFINITY);
        Estimate::by_error(value, error, fit.freedom)
    }))
}

/// The replies in batches of the same size, in order. The few behind the last whole batch are left out.
fn batches<const N: usize>(replies: &[Reply<N>]) -> Option<impl Iterator<Item = &[Reply<N>]>> {
    let size = replies.len() / BATCHES;
    (size >= REPLIES_MIN).then(|| replies.chunks_exact(size).take(BATCHES))
}

fn mean<const N: usize>(batch: &[Reply<N>]) -> ([f64; N], f64) {
    let mut sum = ([0.0; N], 0.0);
    for reply in batch {
        for (sum, one) in sum.0.iter_mut().zip(reply.row) {
            *sum += one;
        }
        sum.1 += reply.y;
    }
    let count = count(batch);
    (sum.0.map(|sum| sum / count), sum.1 / count)
}

fn count<T>(batch: &[T]) -> f64 {
    f64::from(u32::try_from(batch.len()).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean_of(reports: impl Iterator<Item = f64>) -> Option<Estimate> {
        let row = |y: f64| Reply {
            row: [1.0],
            y,
            report: y,
        };
        let replies: Vec<Reply<1>> = reports.map(row).collect();
        let [mean] = estimates(&replies, &solve(&replies)?, |_| 1.0)?;
        Some(mean)
    }

    #[test]
    fn equal_reports_are_known_to_the_resolution() {
        let even = mean_of((0..600).map(|_| 200.0)).unwrap();
        assert!((even.value - 200.0).abs() < 1e-9);
        // Student's t of 14 degrees of freedom is 2.977, and the deviation of a rectangle 0.2887.
        assert!((even.plus_minus - 2.977 * 0.2887).abs() < 1e-3, "{even:?}");
    }

    #[test]
    fn too_few_replies_tell_nothing() {
        assert!(mean_of((0..59).map(|_| 200.0)).is_none());
    }
}
