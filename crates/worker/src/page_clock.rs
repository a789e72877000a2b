//! The clock of the page, as a worker knows it.

use std::time::Duration;

use motorlink_protocol::Instant;

/// How far the worker's clock is ahead of the page's, by the message with the least delay so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PageClock {
    ahead_ms: f64,
}

impl Default for PageClock {
    /// Before the first message every act is new: no port is open, so nothing can drive.
    fn default() -> Self {
        Self {
            ahead_ms: f64::INFINITY,
        }
    }
}

impl PageClock {
    /// A message of this time of the page has arrived.
    pub(crate) fn heard(&mut self, now: Instant, page_ms: f64) {
        self.ahead_ms = self.ahead_ms.min(millis(now) - page_ms);
    }

    /// How long ago this time of the page was.
    pub(crate) fn age(self, now: Instant, page_ms: f64) -> Duration {
        let age_ms = millis(now) - self.ahead_ms - page_ms;
        Duration::try_from_secs_f64(age_ms.max(0.0) / 1000.0).unwrap_or(Duration::MAX)
    }
}

/// A moment in milliseconds, the unit of browsers.
fn millis(now: Instant) -> f64 {
    now.since(Instant::ZERO).as_secs_f64() * 1000.0
}
