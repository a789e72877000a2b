//! Medians, spreads and confidence.

use distrs::StudentsT;

use super::least_squares::Fit;

/// The confidence of all intervals: 99 of 100 such intervals contain the true value.
pub const CONFIDENCE: f64 = 0.99;

/// A value with its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Half the width of its confidence interval at [`CONFIDENCE`].
    pub plus_minus: f64,
}

impl Estimate {
    /// Whether the interval contains this value.
    #[must_use]
    pub fn holds(self, value: f64) -> bool {
        (value - self.value).abs() <= self.plus_minus
    }

    /// Whether it tells more than the order of magnitude: the interval does not contain zero.
    #[must_use]
    pub fn is_measurable(self) -> bool {
        self.plus_minus > 0.0 && !self.holds(0.0)
    }

    /// An estimate from its standard error and degrees of freedom.
    pub(super) fn by_error(value: f64, error: f64, freedom: f64) -> Self {
        let quantile = StudentsT::ppf(f64::midpoint(1.0, CONFIDENCE), freedom);
        Self {
            value,
            plus_minus: error * quantile,
        }
    }

    /// An estimate from the values that follow if each of the repeats is left out once.
    pub(crate) fn by_jackknife(value: f64, without: &[f64]) -> Self {
        let count = f64::from(u32::try_from(without.len()).unwrap_or(u32::MAX));
        let middle = mean(without.iter().copied()).unwrap_or(value);
        let squares: f64 = without.iter().map(|one| (one - middle).powi(2)).sum();
        let error = ((count - 1.0) / count * squares).sqrt();
        Self::by_error(value, error, count - 1.0)
    }

    /// The unknowns of a fit.
    pub(super) fn of<const N: usize>(fit: &Fit<N>) -> [Self; N] {
        let mut errors = fit.errors.into_iter();
        fit.unknowns
            .map(|value| Self::by_error(value, errors.next().unwrap_or(0.0), fit.freedom))
    }

    /// The product of two independent estimates.
    pub(super) fn product(self, other: Self) -> Self {
        let one = self.plus_minus * other.value;
        let two = other.plus_minus * self.value;
        Self {
            value: self.value * other.value,
            plus_minus: one.hypot(two),
        }
    }

    /// One divided by this estimate.
    pub(super) fn inverse(self) -> Self {
        Self {
            value: 1.0 / self.value,
            plus_minus: self.plus_minus / (self.value * self.value),
        }
    }
}

/// Median and quartiles of repeated figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The lower quartile.
    pub low: f64,
    /// The upper quartile.
    pub high: f64,
    /// Number of figures.
    pub count: usize,
}

/// Median and quartiles; `None` without figures. Between two figures they are interpolated linearly (type 7 of
/// Hyndman and Fan 1996).
#[must_use]
pub fn spread(figures: impl IntoIterator<Item = f64>) -> Option<Spread> {
    let mut sorted: Vec<f64> = figures.into_iter().filter(|it| it.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let last = u32::try_from(sorted.len().checked_sub(1)?).ok()?;
    let quantile = |part: f64| {
        let place = part * f64::from(last);
        let below = crate::number::whole(place.floor());
        let at = |place: u32| sorted.get(usize::try_from(place).ok()?).copied();
        let low = at(below)?;
        let high = at((below + 1).min(last))?;
        Some(low + (high - low) * place.fract())
    };
    Some(Spread {
        median: quantile(0.5)?,
        low: quantile(0.25)?,
        high: quantile(0.75)?,
        count: sorted.len(),
    })
}

/// The mean; `None` without values.
pub(super) fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value;
        count += 1.0;
    }
    (count > 0.0).then(|| sum / count)
}
