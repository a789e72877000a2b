//! Does the page still live? A ping is a message, and a hidden page answers messages at once.

use motorlink_protocol::Instant;

use crate::timing::{PAGE_SILENCE_MAX, PING_PERIOD};

/// Pings the page and says when it has not answered for too long.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Watchdog {
    heard: Instant,
    next_ping: Instant,
    bitten: bool,
}

/// What the watchdog wants done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bark {
    /// Ask the page.
    Ping,
    /// The page has been silent for too long. Said once for each silence.
    PageSilent,
}

impl Watchdog {
    pub(crate) fn new(now: Instant) -> Self {
        Self {
            heard: now,
            next_ping: now + PING_PERIOD,
            bitten: false,
        }
    }

    pub(crate) fn answered(&mut self, now: Instant) {
        self.heard = now;
        self.bitten = false;
    }

    /// We were not there ourselves until now: a page that answered before gets its time again.
    pub(crate) fn resumed(&mut self, now: Instant) {
        if !self.bitten {
            self.heard = now;
        }
    }

    /// Whether the page was silent for too long and has not answered since.
    pub(crate) const fn has_bitten(&self) -> bool {
        self.bitten
    }

    pub(crate) fn wake(&mut self, now: Instant) -> Option<Bark> {
        if !self.bitten && now >= self.heard + PAGE_SILENCE_MAX {
            self.bitten = true;
            return Some(Bark::PageSilent);
        }
        (now >= self.next_ping).then(|| {
            self.next_ping = now + PING_PERIOD;
            Bark::Ping
        })
    }

    pub(crate) fn deadline(&self) -> Instant {
        if self.bitten {
            self.next_ping
        } else {
            self.next_ping.min(self.heard + PAGE_SILENCE_MAX)
        }
    }
}
