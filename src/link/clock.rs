//! Converts between the clocks of the worker and the page.

use std::time::Duration;

use motorlink_messages::protocol::Instant;

use crate::ui::clock::{day_us, page_origin_ms};

/// Both clocks have their own origin; both origins are known on the wall clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Clock {
    /// How much later the worker's origin is than the page's.
    offset_ms: f64,
}

impl Clock {
    pub(crate) fn new(page_origin_ms: f64, worker_origin_ms: f64) -> Self {
        Self {
            offset_ms: worker_origin_ms - page_origin_ms,
        }
    }

    /// A time of the worker in milliseconds of the page's `performance.now()`.
    #[allow(
        clippy::cast_precision_loss,
        reason = "microseconds of a session fit into 53 bits for 285 years"
    )]
    pub(crate) fn page_ms(self, instant: Instant) -> f64 {
        instant.as_micros() as f64 / 1000.0 + self.offset_ms
    }

    /// The local time of day of a time of the worker, in microseconds since midnight.
    pub(crate) fn day_us(self, instant: Instant) -> u64 {
        day_us(page_origin_ms() + self.page_ms(instant))
    }

    /// The same for a time this long before the worker's zero.
    pub(crate) fn day_us_before(self, before: Duration) -> u64 {
        let zero_ms = page_origin_ms() + self.page_ms(Instant::ZERO);
        day_us(zero_ms - before.as_secs_f64() * 1_000.0)
    }

    /// A time of the page's `performance.now()` on the worker's clock.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float cast saturates, and a moment before the worker's origin is its origin"
    )]
    pub(crate) fn instant(self, page_ms: f64) -> Instant {
        Instant::from_micros(((page_ms - self.offset_ms) * 1000.0) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moment_has_a_place_on_both_clocks() {
        let clock = Clock::new(1_000.0, 1_250.0);
        let moment = Instant::from_millis(50);
        assert!((clock.page_ms(moment) - 300.0).abs() < 1e-9);
        assert_eq!(clock.instant(300.0), moment);
        assert_eq!(clock.instant(0.0), Instant::ZERO, "before the worker was");
    }
}
