//! Times of the wire.

use std::time::Duration;

/// Silence after which a motor takes the next byte for the first of a frame. A frame takes 0.87 ms,
/// and hosts leave more than this between frames that are not answered.
pub(crate) const FRAME_GAP: Duration = Duration::from_millis(1);

/// Time of `count` bytes on the wire: ten bits each at 115200 baud, 868 us for ten.
pub(crate) fn airtime(count: usize) -> Duration {
    let tenths = u64::try_from(count).unwrap_or(u64::MAX).saturating_mul(868);
    Duration::from_micros(tenths / 10)
}
