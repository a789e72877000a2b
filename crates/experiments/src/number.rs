//! Functions of numbers. In a browser, those of the standard library are large.

/// The nearest whole number that is not negative.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float cast saturates, which is what is meant"
)]
pub(crate) fn whole(value: f64) -> u32 {
    value.round() as u32
}

/// The value, or the bound that it exceeds; `low` for NaN.
#[must_use]
#[allow(
    clippy::manual_clamp,
    reason = "the panic of `f64::clamp` writes its bounds, and that code adds 3 KB to the first visit"
)]
pub const fn limited(value: f64, low: f64, high: f64) -> f64 {
    value.max(low).min(high)
}

/// What is left of the value after whole periods: from 0 up to the period; 0 for NaN. The code of `f64::rem_euclid` would
/// add 2 KB to the first visit.
#[must_use]
pub fn modulo(value: f64, period: f64) -> f64 {
    // Rounding can give a little less than nothing.
    (value - (value / period).floor() * period).max(0.0)
}

/// Sine and cosine of an angle in degrees, by their series up to the precision of a double. The code of `f64::sin_cos`
/// would add 7 KB to a page.
#[must_use]
pub fn sin_cos(degrees: f64) -> (f64, f64) {
    let quarter = (degrees / 90.0 + 0.5).floor();
    let square = (degrees - 90.0 * quarter).to_radians().powi(2);
    let series = |first: f64| {
        let mut sum = 1.0;
        for n in (0..8).rev() {
            let at = first + 2.0 * f64::from(n);
            sum = 1.0 - square / (at * (at + 1.0)) * sum;
        }
        sum
    };
    let sin = (degrees - 90.0 * quarter).to_radians() * series(2.0);
    let cos = series(1.0);
    match modulo(quarter, 4.0) {
        0.0 => (sin, cos),
        1.0 => (cos, -sin),
        2.0 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_after_whole_periods_is_that_of_the_standard_library() {
        for value in [
            0.0, -0.1, 359.9, 360.0, -360.0, 725.5, -1e-12, 1.8e12, -7.25e6,
        ] {
            for period in [1.0, 360.0, 86_400_000.0] {
                let left = modulo(value, period);
                let apart = (left - value.rem_euclid(period)).abs();
                assert!(
                    apart < 1e-6 || (apart - period).abs() < 1e-6,
                    "{value} {period}"
                );
                assert!((0.0..=period).contains(&left), "{value} {period}");
            }
        }
    }

    #[test]
    fn sine_and_cosine_are_those_of_the_standard_library() {
        for n in -4_000..4_000 {
            let degrees = f64::from(n) * 0.37;
            let (sin, cos) = sin_cos(degrees);
            let (exact_sin, exact_cos) = degrees.to_radians().sin_cos();
            let apart = (sin - exact_sin).abs().max((cos - exact_cos).abs());
            assert!(apart < 1e-13, "{degrees}: {sin}, {cos}");
        }
    }
}
