//! Watchdog of the page. It pings by message, because a hidden page still answers messages at once.

use motorlink_protocol::Instant;

use crate::timing::{PAGE_SILENCE_MAX, PING_PERIOD};

/// Pings the page and expires when the page is silent for too long.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Watchdog {
    last_answer: Instant,
    next_ping: Instant,
    expired: bool,
}

/// What the bus must do for the watchdog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WatchdogAction {
    /// Ping the page.
    Ping,
    /// The page has been silent for too long. Reported once per silence.
    Expired,
}

impl Watchdog {
    pub(crate) fn new(now: Instant) -> Self {
        Self {
            last_answer: now,
            next_ping: now + PING_PERIOD,
            expired: false,
        }
    }

    pub(crate) fn answered(&mut self, now: Instant) {
        self.last_answer = now;
        self.expired = false;
    }

    /// The bus itself did not run until now: a page that answered before gets its full time again.
    pub(crate) fn resumed(&mut self, now: Instant) {
        if !self.expired {
            self.last_answer = now;
        }
    }

    /// Whether the page was silent for too long and has not answered since.
    pub(crate) const fn has_expired(&self) -> bool {
        self.expired
    }

    pub(crate) fn poll(&mut self, now: Instant) -> Option<WatchdogAction> {
        if !self.expired && now >= self.last_answer + PAGE_SILENCE_MAX {
            self.expired = true;
            return Some(WatchdogAction::Expired);
        }
        (now >= self.next_ping).then(|| {
            self.next_ping = now + PING_PERIOD;
            WatchdogAction::Ping
        })
    }

    pub(crate) fn deadline(&self) -> Instant {
        if self.expired {
            self.next_ping
        } else {
            self.next_ping.min(self.last_answer + PAGE_SILENCE_MAX)
        }
    }
}
