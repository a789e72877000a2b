//! How a raw frame is repeated, and what the page shows of it.

use motorlink_protocol::{Frame, Layout};

/// How often a raw frame is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Repeat {
    /// Once.
    Once,
    /// Repeatedly.
    Times {
        /// Number of frames; 0 is until stopped.
        count: u32,
        /// Time between two frames.
        interval: RawInterval,
    },
}

/// Time between two raw frames, 2-60,000 ms. The motor accepts up to 500 frames per second.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("frames can be 2 to 60,000 ms apart")]
pub struct IntervalOutOfRange;

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

/// Progress of a raw frame, and the last answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawStatus {
    /// The frame.
    pub frame: Frame,
    /// Number of frames to send; 0 is until stopped.
    pub count: u32,
    /// Number of frames sent.
    pub sent: u32,
    /// Number of frames answered.
    pub answered: u32,
    /// Whether more frames follow.
    pub running: bool,
    /// Answer to the last frame, after its reply window.
    pub last: Option<RawAnswer>,
}

/// Answer to a raw frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RawAnswer {
    /// A good frame of a motor.
    Reply {
        /// The bytes.
        frame: Frame,
        /// Layout of bytes 6 and 7; `None` if the request is uncertain.
        asked: Option<Layout>,
        /// Round trip.
        after_us: u32,
    },
    /// Bytes that are not a good frame.
    Garbled,
    /// The frame has no answer: mode switch, set ID.
    NoneExpected,
    /// The port refused the frame.
    NotSent,
    /// No byte.
    Silence {
        /// Length of the reply window.
        waited_us: u32,
    },
}
