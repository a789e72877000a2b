//! Conversion of floats to counts.

/// The nearest whole number that is not negative.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float cast saturates, which is what is meant"
)]
pub(crate) fn whole(value: f64) -> u32 {
    value.round() as u32
}
