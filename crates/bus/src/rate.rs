//! The command rate: as set, and as measured.

use std::time::Duration;

use motorlink_protocol::Instant;

use crate::last_second::LastSecond;

/// Drive frames per second for each driven motor, 1-500. The motor accepts up to 500 and needs at
/// least 50.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "u16", into = "u16"))]
pub struct CommandRate(u16);

/// A rate outside 1-500 Hz.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the command rate goes from 1 to 500 Hz")]
pub struct RateOutOfRange;

impl CommandRate {
    /// Lowest rate in Hz.
    pub const MIN: u16 = 1;
    /// Highest rate in Hz.
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

    /// Frames per second.
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

/// Counts events of the last second.
#[derive(Clone, Debug, Default)]
pub(crate) struct RateMeter(LastSecond<u16>);

impl RateMeter {
    pub(crate) fn count(&mut self, now: Instant) {
        let slot = self.0.now(now);
        *slot = slot.saturating_add(1);
    }

    /// Events per second, over the last second.
    pub(crate) fn hertz(&self, now: Instant) -> u16 {
        let over: u32 = self.0.over(now).map(u32::from).sum();
        // Nine slots, scaled to ten.
        u16::try_from((over * 10 + 4) / 9).unwrap_or(u16::MAX)
    }
}
