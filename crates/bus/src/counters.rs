//! Counters of the line.

use std::time::Duration;

/// Counts how exchanges end and what else the line carries, since the bus began.
///
/// Silence, a bad CRC and a wrong ID are events of a bus, not errors. Each has its own counter
/// because each has its own cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counters {
    /// Requests that ask for an answer.
    pub requests: u64,
    /// Requests answered in their window.
    pub replies: u64,
    /// Windows with no bytes except an echo.
    pub silences: u64,
    /// Windows with ten bytes or more and no good CRC: flipped bits, or a collision.
    pub bad_crcs: u64,
    /// Windows with less than a frame.
    pub fragments: u64,
    /// Good frames of another motor than the one that was asked.
    pub wrong_ids: u64,
    /// Replies that came after their window. Each window has counted as one without a reply.
    pub late: u64,
    /// Drive frames and queries that were never sent, because the computer was too late for them.
    pub not_asked: u64,
    /// Requests echoed whole.
    pub echoes_whole: u64,
    /// Requests echoed in part.
    pub echoes_cut: u64,
    /// Bytes outside any frame and echo.
    pub junk_bytes: u64,
    /// Bytes `00` or `FF` among them, where nothing else was: the levels of a pair that nothing drives.
    pub level_bytes: u64,
    /// Bytes of text among the junk, where nothing else was and they were eight or more.
    pub text_bytes: u64,
    /// Chunks of exactly 32 bytes, as from an adapter that delivers only full blocks.
    pub blocks: u64,
}

impl Counters {
    /// Requests whose reply never came, or came damaged. A late reply is not lost.
    #[must_use]
    pub const fn lost(&self) -> u64 {
        let without_reply = self
            .silences
            .saturating_add(self.bad_crcs)
            .saturating_add(self.fragments);
        without_reply.saturating_sub(self.late)
    }
}

/// Quality of the link to one motor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LinkQuality {
    /// Drive frames per second over the last second.
    pub command_hz: u16,
    /// Median round trip of the last exchanges in microseconds; `None` before the first reply, and while
    /// the motor is silent.
    pub round_trip_us: Option<u32>,
    /// Requests without a good reply among the last 100, in per mille; `None` before the first, and
    /// while the motor is silent. A late reply is not lost.
    pub loss_per_mille: Option<u16>,
    /// Requests among the last 100 whose reply came after its window, in per mille; `None` before the
    /// first, and while the motor is silent.
    pub late_per_mille: Option<u16>,
}

/// Losses and late replies among the last 100 exchanges.
#[derive(Clone, Debug, Default)]
pub(crate) struct LossMeter {
    /// One bit per exchange, the newest in bit 0; 1 is lost.
    lost: u128,
    /// The same of those that were answered late.
    late: u128,
    seen: u8,
}

impl LossMeter {
    const DEPTH: u8 = 100;

    pub(crate) fn count(&mut self, lost: bool) {
        let newest = |bits: u128| (bits << 1) & ((1 << Self::DEPTH) - 1);
        self.lost = newest(self.lost) | u128::from(lost);
        self.late = newest(self.late);
        self.seen = (self.seen + 1).min(Self::DEPTH);
    }

    /// A reply came after its window: the last lost exchange was a late one.
    pub(crate) fn answered_late(&mut self) {
        let last_lost = self.lost & self.lost.wrapping_neg();
        self.lost ^= last_lost;
        self.late |= last_lost;
    }

    /// Number of recorded exchanges, and how many of them had no reply in their window.
    pub(crate) const fn known(&self) -> (u32, u32) {
        (self.seen as u32, (self.lost | self.late).count_ones())
    }

    /// Share of the lost exchanges.
    pub(crate) fn per_mille(&self) -> Option<u16> {
        self.share(self.lost)
    }

    /// Share of those that were answered late.
    pub(crate) fn late_per_mille(&self) -> Option<u16> {
        self.share(self.late)
    }

    fn share(&self, of: u128) -> Option<u16> {
        let share = (of.count_ones() * 1000).checked_div(u32::from(self.seen))?;
        u16::try_from(share).ok()
    }
}

/// Rounds of one motor that the computer was too late for.
///
/// A short delay is caught up. So a dropped round counts only if calls came late since the bus was last on schedule:
/// a slow line drops rounds too.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MissedRounds {
    /// How late calls came since the motor was last asked on schedule.
    late_by: Duration,
    /// The dropped time that is not yet a whole round.
    rest: Duration,
}

impl MissedRounds {
    /// A call came so late.
    pub(crate) fn called_late(&mut self, by: Duration) {
        self.late_by += by;
    }

    /// A request goes out, `behind` its schedule, of which `dropped` will not be caught up. Returns the rounds that
    /// are missed for good.
    pub(crate) fn sent(&mut self, behind: Duration, dropped: Duration, period: Duration) -> u64 {
        let by_computer = dropped.min(self.late_by);
        self.late_by = self.late_by.saturating_sub(by_computer).min(behind);
        self.rest += by_computer;
        let period_us = period.as_micros().max(1);
        let rounds = self.rest.as_micros() / period_us;
        let rounds = u64::try_from(rounds).unwrap_or(u64::MAX);
        self.rest = self
            .rest
            .saturating_sub(period.saturating_mul(u32::try_from(rounds).unwrap_or(u32::MAX)));
        rounds
    }
}
