//! Numbers of the mathematics (`f64`) and of counting.

/// The nearest whole number from 0 on.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float cast saturates, which is what is meant"
)]
pub(crate) fn whole(value: f64) -> u32 {
    value.round() as u32
}
