//! Mathematical functions of the browser: compiled into the page they would add 7 KB to the first visit.

pub(crate) use motorlink_messages::experiments::number::{limited, modulo};

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
