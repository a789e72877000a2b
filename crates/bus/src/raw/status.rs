//! How a raw frame is repeated, and what the page shows of it.

use motorlink_protocol::{Frame, Layout};

/// How often a frame that a person wrote is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Repeat {
    /// Once.
    Once,
    /// So many times, so far apart.
    Times {
        /// How often; 0 is until stopped.
        count: u32,
        /// How far apart.
        interval: RawInterval,
    },
}

/// Time between two frames that a person wrote, 2-60,000 ms: the motor accepts up to 500 frames a
/// second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "u16", into = "u16"))]
pub struct RawInterval(u16);

impl RawInterval {
    /// The shortest, in milliseconds.
    pub const MIN_MS: u16 = 2;
    /// The longest, in milliseconds.
    pub const MAX_MS: u16 = 60_000;

    /// An interval in milliseconds.
    ///
    /// # Errors
    /// Outside 2..=60,000.
    pub const fn new(millis: u16) -> Result<Self, IntervalOutOfRange> {
        if millis < Self::MIN_MS || millis > Self::MAX_MS {
            Err(IntervalOutOfRange)
        } else {
            Ok(Self(millis))
        }
    }

    /// In milliseconds.
    #[must_use]
    pub const fn millis(self) -> u16 {
        self.0
    }
}

/// An interval outside 2-60,000 ms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntervalOutOfRange;

impl std::fmt::Display for IntervalOutOfRange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("frames can be 2 to 60,000 ms apart")
    }
}

impl std::error::Error for IntervalOutOfRange {}

impl TryFrom<u16> for RawInterval {
    type Error = IntervalOutOfRange;

    fn try_from(millis: u16) -> Result<Self, Self::Error> {
        Self::new(millis)
    }
}

impl From<RawInterval> for u16 {
    fn from(interval: RawInterval) -> Self {
        interval.0
    }
}

/// A frame that a person wrote: how often it went out, and what came back last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawStatus {
    /// The frame.
    pub frame: Frame,
    /// How often it is to be sent; 0 is until stopped.
    pub count: u32,
    /// How often it was sent.
    pub sent: u32,
    /// How many of them were answered.
    pub answered: u32,
    /// Whether more are to be sent.
    pub running: bool,
    /// What came after the last one, once its window is over.
    pub last: Option<RawAnswer>,
}

/// What came after a frame that a person wrote.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RawAnswer {
    /// A good frame of a motor.
    Reply {
        /// Its bytes.
        frame: Frame,
        /// What was asked; `None` where that is not certain.
        asked: Option<Layout>,
        /// How long it took.
        after_us: u32,
    },
    /// Bytes that are no good frame.
    Garbled,
    /// Such a frame has no answer: a mode switch, set ID.
    NoneExpected,
    /// The port did not take the frame.
    NotSent,
    /// Nothing.
    Silence {
        /// How long it was waited for.
        waited_us: u32,
    },
}
