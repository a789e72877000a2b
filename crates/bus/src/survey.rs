//! What the page is told of scans, ID changes and frames that a person wrote.

use motorlink_protocol::{AssignableId, Frame, Layout, MotorId};

/// A full scan or an ID change under way.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SurveyStatus {
    /// What was driven is being stopped first.
    Stopping,
    /// Every address is being asked.
    Scanning {
        /// Addresses that were asked at least once, 0-254.
        asked: u16,
        /// Addresses in all: 254.
        of: u16,
        /// How long it may still take, in milliseconds; a guess from the windows so far.
        left_ms: u32,
        /// Who has answered so far, in the order of IDs.
        found: Vec<MotorId>,
    },
    /// A new ID is being set and verified.
    SettingId {
        /// The present one.
        from: MotorId,
        /// The new one.
        to: AssignableId,
    },
}

/// How a full scan ended.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ScanReport {
    /// Who answered, in the order of IDs.
    pub found: Vec<MotorId>,
    /// Addresses at which every look brought noise and none a reply: two motors that share an ID, or
    /// a bad line.
    pub noisy: Vec<MotorId>,
    /// Addresses that were asked: 254, or fewer where it was cancelled.
    pub asked: u16,
    /// Whether every address was asked. A cancelled scan proves nothing.
    pub complete: bool,
    /// How long it took, in milliseconds.
    pub took_ms: u32,
}

/// How an ID change ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum IdChangeOutcome {
    /// The new ID answers and the old one is silent.
    Changed,
    /// The old ID still answers and the new one does not: the motor has taken an ID since power-up
    /// already, or takes more frames in a row than it has heard.
    Kept {
        /// How many were sent.
        frames: SetIdFrames,
    },
    /// Neither answers.
    Lost,
    /// Both answer: there is more than one motor.
    Both,
    /// Just before the first frame, the bus was not as the scan had found it; nothing was sent.
    NotAlone,
    /// A motor did not confirm its stop; nothing was sent.
    NotStopped,
    /// Stopped by a person or by the page's end. Where frames were sent, the ID may be either.
    Cancelled {
        /// Whether set-ID frames had been sent.
        frames_sent: u8,
    },
}

/// How many set-ID frames are sent in a row.
///
/// A DDSM115 takes an ID by the fifth (the maker's samples); M0601 units are reported to take more, and
/// no source says how many. So a person may double the number three times. A motor that has heard eight
/// times the maker's five and keeps its ID has another reason: it has taken one since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SetIdFrames {
    /// As the maker's samples send.
    #[default]
    Five,
    /// Twice as many.
    Ten,
    /// Four times as many.
    Twenty,
    /// The most that are sent.
    Forty,
}

impl SetIdFrames {
    /// The most that are sent.
    pub const MAX: Self = Self::Forty;

    /// How many.
    #[must_use]
    pub const fn count(self) -> u8 {
        match self {
            Self::Five => 5,
            Self::Ten => 10,
            Self::Twenty => 20,
            Self::Forty => 40,
        }
    }

    /// What to try where these were not enough.
    #[must_use]
    pub const fn more(self) -> Option<Self> {
        match self {
            Self::Five => Some(Self::Ten),
            Self::Ten => Some(Self::Twenty),
            Self::Twenty => Some(Self::Forty),
            Self::Forty => None,
        }
    }
}

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
