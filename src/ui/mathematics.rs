//! Mathematical functions of the browser: compiled into the page they would add 7 KB to the first visit.

/// The value, or the bound that it exceeds; `low` for NaN.
#[allow(
    clippy::manual_clamp,
    reason = "the panic of `f64::clamp` writes its bounds, and that code adds 3 KB to the first visit"
)]
pub(crate) const fn limited(value: f64, low: f64, high: f64) -> f64 {
    value.max(low).min(high)
}

/// What is left of the value after whole periods: from 0 up to the period; 0 for NaN. The code of `f64::rem_euclid` would
/// add 2 KB to the first visit.
pub(crate) fn modulo(value: f64, period: f64) -> f64 {
    // Rounding can give a little less than nothing.
    (value - (value / period).floor() * period).max(0.0)
}

/// Sine and cosine of an angle in degrees.
#[cfg(target_arch = "wasm32")]
pub(crate) fn sin_cos(degrees: f64) -> (f64, f64) {
    let radians = degrees.to_radians();
    (js_sys::Math::sin(radians), js_sys::Math::cos(radians))
}

/// Sine and cosine of an angle in degrees.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn sin_cos(degrees: f64) -> (f64, f64) {
    degrees.to_radians().sin_cos()
}

/// e to this power.
#[cfg(target_arch = "wasm32")]
pub(crate) fn exp(power: f64) -> f64 {
    js_sys::Math::exp(power)
}

/// e to this power.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn exp(power: f64) -> f64 {
    power.exp()
}

/// The angle in degrees whose tangent is `y / x`, in the right quadrant.
#[cfg(target_arch = "wasm32")]
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    js_sys::Math::atan2(y, x).to_degrees()
}

/// The angle in degrees whose tangent is `y / x`, in the right quadrant.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    y.atan2(x).to_degrees()
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
}
