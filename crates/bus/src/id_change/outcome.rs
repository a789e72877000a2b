//! Result of an ID change, and how many set-ID frames it sends.

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
