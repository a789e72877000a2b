//! Result of an ID change, and how many set-ID frames it sends.

/// Result of an ID change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum IdChangeOutcome {
    /// The new ID answers and the old one is silent.
    Changed,
    /// The old ID answers and the new one does not: the motor has already taken an ID since
    /// power-up, or needs more set-ID frames.
    Kept {
        /// Number of frames sent.
        frames: SetIdFrames,
    },
    /// Neither answers.
    Lost,
    /// Both answer: there is more than one motor.
    Both,
    /// The check before the first frame did not find exactly this motor. No frame was sent.
    NotAlone,
    /// A motor did not confirm its stop. No frame was sent.
    NotStopped,
    /// Cancelled by the operator or by the end of the page. If frames were sent, the ID may be
    /// either.
    Cancelled {
        /// Number of set-ID frames sent.
        frames_sent: u8,
    },
}

/// Number of set-ID frames in a row.
///
/// A DDSM115 takes an ID by the fifth frame (the maker's samples); M0601 units are reported to need
/// more, and no source says how many. So the operator may double the number three times. A motor
/// that ignores eight times the maker's five has another reason: it has taken an ID since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SetIdFrames {
    /// As in the maker's samples.
    #[default]
    Five,
    /// Twice as many.
    Ten,
    /// Four times as many.
    Twenty,
    /// The most frames.
    Forty,
}

impl SetIdFrames {
    /// The most frames.
    pub const MAX: Self = Self::Forty;

    /// Number of frames.
    #[must_use]
    pub const fn count(self) -> u8 {
        match self {
            Self::Five => 5,
            Self::Ten => 10,
            Self::Twenty => 20,
            Self::Forty => 40,
        }
    }

    /// The next larger number, to try after a failure.
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
