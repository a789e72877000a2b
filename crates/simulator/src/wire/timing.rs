//! Times of the wire.

use std::time::Duration;

/// Silence after which a motor takes the next byte for the first of a frame. A byte takes 0.09 to
/// 0.26 ms, and hosts leave more than this between frames that are not answered.
pub(crate) const FRAME_GAP: Duration = Duration::from_millis(1);

/// Time of `count` bytes on the wire, ten bits each: 868 us for ten at 115200 baud.
pub(crate) fn airtime(baud: u32, count: usize) -> Duration {
    let ten_bytes_us = 100_000_000 / u64::from(baud.max(1));
    let count = u64::try_from(count).unwrap_or(u64::MAX);
    Duration::from_micros(count.saturating_mul(ten_bytes_us) / 10)
}
