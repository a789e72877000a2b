//! Numbers from the physics (f64) to the narrow types that the wire and the API carry.

/// For values that people and tests read; physics itself stays in f64.
#[allow(
    clippy::cast_possible_truncation,
    reason = "precision beyond f32 is of no use to a reader"
)]
pub(crate) const fn narrow(value: f64) -> f32 {
    value as f32
}

/// Nearest whole number, saturated to `i16`.
#[allow(
    clippy::cast_possible_truncation,
    reason = "a float cast saturates, which is what is meant"
)]
pub(crate) fn nearest_i16(value: f64) -> i16 {
    value.round() as i16
}

/// Nearest whole number, saturated to `i32`.
#[allow(
    clippy::cast_possible_truncation,
    reason = "a float cast saturates, which is what is meant"
)]
pub(crate) fn nearest_i32(value: f64) -> i32 {
    value.round() as i32
}

/// Nearest whole number, saturated to `u16`.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float cast saturates, which is what is meant"
)]
pub(crate) fn nearest_u16(value: f64) -> u16 {
    value.round() as u16
}

/// Nearest whole number, saturated to `u8`.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float cast saturates, which is what is meant"
)]
pub(crate) fn nearest_u8(value: f64) -> u8 {
    value.round() as u8
}
