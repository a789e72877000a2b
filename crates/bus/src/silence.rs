//! A short time in which the frames of a driven motor are withheld, to measure what its firmware does then.

use std::time::Duration;

use motorlink_protocol::Instant;

/// Frames are withheld for no longer than this in a row: the measurement needs 0.8 s, and the wheel may keep turning
/// meanwhile.
pub const WITHHELD_MAX: Duration = Duration::from_secs(1);

/// Which frames are withheld.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Withheld {
    /// The drive frames of the motor. It is queried at the rate of its drive frames instead.
    DriveFrames,
    /// Its drive frames, and all queries on the line.
    Requests,
}

/// A time without drive frames, until the next one is sent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Silence {
    withheld: Withheld,
    /// When the first of the frames would have been due that have been withheld in a row.
    since: Instant,
    until: Instant,
}

impl Silence {
    /// A time without drive frames, which continues the one before if no frame was sent since.
    pub(crate) fn begin(
        now: Instant,
        before: Option<Self>,
        time: Duration,
        withheld: Withheld,
    ) -> Self {
        let since = before.map_or(now, |before| before.since);
        Self {
            withheld,
            since,
            until: (now + time).min(since + WITHHELD_MAX),
        }
    }

    pub(crate) const fn until(self) -> Instant {
        self.until
    }

    /// Until when the line carries no query.
    pub(crate) fn unasked_until(self) -> Option<Instant> {
        (self.withheld == Withheld::Requests).then_some(self.until)
    }

    pub(crate) fn end(&mut self, now: Instant) {
        self.until = self.until.min(now);
    }
}
