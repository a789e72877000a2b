//! Bounds the junk that the packet log gets.

use std::time::Duration;

use motorlink_protocol::Instant;

/// Junk events that are logged in a second: one for each exchange at the highest rate. A device that sends text
/// makes 1,150, and in 15 minutes they would replace all else in a log of a million.
const JUNK_LOGGED_MAX: u32 = 500;

/// The junk events of the present second.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JunkLogged {
    since: Instant,
    events: u32,
}

impl JunkLogged {
    /// Whether an event at this time is logged.
    pub(crate) fn admits(&mut self, at: Instant) -> bool {
        if at.since(self.since) >= Duration::from_secs(1) {
            *self = Self {
                since: at,
                events: 0,
            };
        }
        self.events = self.events.saturating_add(1);
        self.events <= JUNK_LOGGED_MAX
    }
}
