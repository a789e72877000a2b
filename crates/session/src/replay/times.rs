//! The clock of a replay: the monotonic clock of the session, from its first to its last record.

use motorlink_protocol::Instant;

use crate::{clock::zero_unix_us, overview::Overview};

/// The first and the last time of a session.
#[derive(Clone, Copy, Debug)]
pub(super) struct Times {
    pub(super) first: Instant,
    pub(super) end: Instant,
    first_utc_ns: u64,
}

impl Times {
    pub(super) fn of(overview: &Overview) -> Self {
        let (first, first_utc_ns) = overview.begins().unwrap_or_default();
        Self {
            first,
            end: first + overview.duration(),
            first_utc_ns,
        }
    }

    /// The wall clock at [`Instant::ZERO`], in microseconds since 1970.
    pub(super) fn zero_unix_us(self) -> i64 {
        zero_unix_us(self.first, self.first_utc_ns)
    }

    pub(super) const fn after_us(self, at: Instant) -> u64 {
        at.as_micros().saturating_sub(self.first.as_micros())
    }

    /// The time so long after the first record, at most the end.
    pub(super) fn at(self, after_us: u64) -> Instant {
        let at = self.first.as_micros().saturating_add(after_us);
        self.end.min(Instant::from_micros(at))
    }

    /// In nanoseconds since 1970, if the wall clock was not set since the first record.
    pub(super) const fn utc_ns(self, at: Instant) -> u64 {
        let after_ns = self.after_us(at).saturating_mul(1_000);
        self.first_utc_ns.saturating_add(after_ns)
    }

    /// The time of a record behind one at `last`. A time that goes back, or is behind the end, does not count.
    pub(super) fn limited(self, at: Instant, last: Instant) -> Instant {
        at.min(self.end).max(last)
    }
}
