//! Counters of the line.

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
    /// Good frames of a motor after its window.
    pub late: u64,
    /// Requests echoed whole.
    pub echoes_whole: u64,
    /// Requests echoed in part.
    pub echoes_cut: u64,
    /// Bytes outside any frame and echo.
    pub junk_bytes: u64,
}

/// Quality of the link to one motor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LinkQuality {
    /// Drive frames per second over the last second.
    pub command_hz: u16,
    /// Median round trip of the last exchanges in microseconds; `None` before the first reply.
    pub round_trip_us: Option<u32>,
    /// Requests without a good reply among the last 100, in per mille; `None` before the first.
    pub loss_per_mille: Option<u16>,
}

/// Loss over the last 100 exchanges.
#[derive(Clone, Debug, Default)]
pub(crate) struct LossMeter {
    /// One bit per exchange, the newest in bit 0; 1 is lost.
    lost: u128,
    seen: u8,
}

impl LossMeter {
    const DEPTH: u8 = 100;

    pub(crate) fn count(&mut self, lost: bool) {
        self.lost = ((self.lost << 1) | u128::from(lost)) & ((1 << Self::DEPTH) - 1);
        self.seen = (self.seen + 1).min(Self::DEPTH);
    }

    /// Number of recorded exchanges, and how many of them were lost.
    pub(crate) const fn known(&self) -> (u32, u32) {
        (self.seen as u32, self.lost.count_ones())
    }

    pub(crate) fn per_mille(&self) -> Option<u16> {
        let lost = self.lost.count_ones() * 1000;
        let share = lost.checked_div(u32::from(self.seen))?;
        u16::try_from(share).ok()
    }
}
