//! Errors of the line that the browser reports: counted, and told to the page once a second at most.

use std::time::Duration;

use motorlink_protocol::Instant;

/// A line with a fault may have an error with every byte.
const TOLD_EVERY: Duration = Duration::from_secs(1);

/// The errors since the port was opened.
#[derive(Debug, Default)]
pub(crate) struct LineErrors {
    count: u32,
    told: Option<Instant>,
}

impl LineErrors {
    /// Counts one. Gives the number if the page must know now.
    pub(crate) fn count(&mut self, now: Instant) -> Option<u32> {
        self.count = self.count.saturating_add(1);
        let is_due = self.told.is_none_or(|told| now.since(told) >= TOLD_EVERY);
        is_due.then(|| {
            self.told = Some(now);
            self.count
        })
    }
}
