//! At most 500 frames a second.

use std::time::Duration;

use motorlink_protocol::Instant;

/// Time that a frame costs: 500 a second (maker's manual).
const COST: Duration = Duration::from_millis(2);
/// How much may be saved up. A host that keeps to 500 a second on average is never refused for
/// jitter of a few frames.
const SAVED_MAX: Duration = Duration::from_millis(20);

/// A bucket that fills with time and is emptied by frames.
#[derive(Clone, Debug)]
pub(crate) struct FrameRate {
    saved: Duration,
    at: Instant,
}

impl Default for FrameRate {
    fn default() -> Self {
        Self {
            saved: SAVED_MAX,
            at: Instant::ZERO,
        }
    }
}

impl FrameRate {
    /// Whether a frame heard now is taken; beyond the limit it is as if it had not come.
    pub(crate) fn admits(&mut self, now: Instant) -> bool {
        self.saved = self.saved.saturating_add(now.since(self.at)).min(SAVED_MAX);
        self.at = now;
        let left = self.saved.checked_sub(COST);
        self.saved = left.unwrap_or(self.saved);
        left.is_some()
    }
}
