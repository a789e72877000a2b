//! A frame: ten bytes, with or without a meaning.

use core::{fmt, str::FromStr, time::Duration};

use crate::crc8::crc8;

/// Bytes in every frame, both ways.
pub const FRAME_LEN: usize = 10;

/// Time that a frame occupies the line: 10 bytes of 10 bits at 115200 baud.
pub const FRAME_AIRTIME: Duration = Duration::from_micros(868);

/// Ten bytes as they stand on the wire.
///
/// A frame may be malformed: it can still be shown, logged and sent. It is written, and read, as
/// hex bytes with spaces: `01 74 00 00 00 00 00 00 00 04`.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Frame([u8; FRAME_LEN]);

impl Frame {
    /// The frame with exactly these bytes.
    #[must_use]
    pub const fn new(bytes: [u8; FRAME_LEN]) -> Self {
        Self(bytes)
    }

    /// The frame with these nine bytes and their CRC.
    #[must_use]
    pub fn with_crc(body: [u8; FRAME_LEN - 1]) -> Self {
        let [b0, b1, b2, b3, b4, b5, b6, b7, b8] = body;
        Self([b0, b1, b2, b3, b4, b5, b6, b7, b8, crc8(&body)])
    }

    /// All ten bytes.
    #[must_use]
    pub const fn bytes(&self) -> &[u8; FRAME_LEN] {
        &self.0
    }

    /// The CRC that bytes 0-8 ask for.
    #[must_use]
    pub fn crc_expected(&self) -> u8 {
        let [body @ .., _] = &self.0;
        crc8(body)
    }

    /// Byte 9, which is the CRC in every frame but the mode switch and set ID.
    #[must_use]
    pub const fn crc_found(&self) -> u8 {
        let [.., last] = self.0;
        last
    }

    /// Whether byte 9 is the CRC of the rest.
    #[must_use]
    pub fn crc_holds(&self) -> bool {
        self.crc_found() == self.crc_expected()
    }
}

impl fmt::Display for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, byte) in self.0.iter().enumerate() {
            let space = if place == 0 { "" } else { " " };
            write!(f, "{space}{byte:02X}")?;
        }
        Ok(())
    }
}

impl fmt::Debug for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{self}]")
    }
}

/// Why a text is not a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameParseError {
    /// The word at this place (from 0) is not a byte in hex.
    NotHex {
        /// Place of the word, from 0.
        place: usize,
    },
    /// There are not ten bytes.
    Length {
        /// How many there are.
        bytes: usize,
    },
}

impl fmt::Display for FrameParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotHex { place } => {
                write!(f, "byte {place} is not two hex digits, such as 0A or FF")
            }
            Self::Length { bytes } => write!(f, "a frame has 10 bytes, this has {bytes}"),
        }
    }
}

impl core::error::Error for FrameParseError {}

impl FromStr for Frame {
    type Err = FrameParseError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut bytes = [0; FRAME_LEN];
        let mut length = 0;
        for (place, word) in text.split_ascii_whitespace().enumerate() {
            let is_hex_byte =
                word.len() == 2 && word.bytes().all(|digit| digit.is_ascii_hexdigit());
            let byte = u8::from_str_radix(word, 16)
                .ok()
                .filter(|_| is_hex_byte)
                .ok_or(FrameParseError::NotHex { place })?;
            if let Some(slot) = bytes.get_mut(place) {
                *slot = byte;
            }
            length = place + 1;
        }
        if length == FRAME_LEN {
            Ok(Self(bytes))
        } else {
            Err(FrameParseError::Length { bytes: length })
        }
    }
}
