//! How often a driven motor is spoken to: as set, and as measured.

use std::{fmt, time::Duration};

use motorlink_protocol::Instant;

/// Drive frames a second for each driven motor, 1-500. The motor accepts up to 500 frames a second
/// and wants at least 50.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "u16", into = "u16"))]
pub struct CommandRate(u16);

/// A rate outside 1-500 Hz.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RateOutOfRange;

impl CommandRate {
    /// Least rate in Hz.
    pub const MIN: u16 = 1;
    /// Greatest rate in Hz.
    pub const MAX: u16 = 500;

    /// A rate in Hz.
    ///
    /// # Errors
    /// Outside 1..=500.
    pub const fn new(hertz: u16) -> Result<Self, RateOutOfRange> {
        if hertz < Self::MIN || hertz > Self::MAX {
            Err(RateOutOfRange)
        } else {
            Ok(Self(hertz))
        }
    }

    /// Frames a second.
    #[must_use]
    pub const fn hertz(self) -> u16 {
        self.0
    }

    /// Time between two frames.
    #[must_use]
    pub fn period(self) -> Duration {
        Duration::from_secs(1) / u32::from(self.0)
    }
}

impl Default for CommandRate {
    fn default() -> Self {
        Self(50)
    }
}

impl TryFrom<u16> for CommandRate {
    type Error = RateOutOfRange;

    fn try_from(hertz: u16) -> Result<Self, Self::Error> {
        Self::new(hertz)
    }
}

impl From<CommandRate> for u16 {
    fn from(rate: CommandRate) -> Self {
        rate.0
    }
}

impl fmt::Display for RateOutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the command rate goes from 1 to 500 Hz")
    }
}

impl std::error::Error for RateOutOfRange {}

const SLOTS: usize = 10;
const SLOT_US: u64 = 100_000;

/// Counts what happened in the last second, in ten slots of 100 ms.
#[derive(Clone, Debug, Default)]
pub(crate) struct RateMeter {
    slots: [u16; SLOTS],
    /// Number of the slot that was counted in last, since the epoch.
    newest: u64,
}

impl RateMeter {
    pub(crate) fn count(&mut self, now: Instant) {
        self.advance(now);
        if let Some(slot) = self.slots.get_mut(place(self.newest)) {
            *slot = slot.saturating_add(1);
        }
    }

    /// Events in the last ten slots that are over, which is one second.
    pub(crate) fn hertz(&self, now: Instant) -> u16 {
        let mut moved = self.clone();
        moved.advance(now);
        // The slot in progress is not over: the nine before it, scaled to a second.
        let current = moved.slots.get(place(moved.newest)).copied().unwrap_or(0);
        let over: u32 = moved
            .slots
            .iter()
            .map(|count| u32::from(*count))
            .sum::<u32>()
            - u32::from(current);
        u16::try_from((over * 10 + 4) / 9).unwrap_or(u16::MAX)
    }

    fn advance(&mut self, now: Instant) {
        let slot = now.as_micros() / SLOT_US;
        let passed = slot.saturating_sub(self.newest).min(SLOTS as u64);
        for back in 0..passed {
            if let Some(stale) = self.slots.get_mut(place(slot - back)) {
                *stale = 0;
            }
        }
        self.newest = self.newest.max(slot);
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "the remainder is below ten"
)]
const fn place(slot: u64) -> usize {
    (slot % SLOTS as u64) as usize
}
