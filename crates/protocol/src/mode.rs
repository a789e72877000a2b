//! The loops of every model.

use core::fmt;

/// The active loop, which decides how a drive frame's value is read. [`Model::modes`](crate::family::Model::modes)
/// lists the loops of a model.
///
/// A motor powers up in the velocity loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Mode {
    /// No loop: the value is a share of the supply. Only of a model with separate frames.
    OpenLoop,
    /// Torque: the value is a raw current. Byte 1 is 1.
    Current,
    /// Speed: the value is in rpm. Byte 1 is 2.
    Velocity,
    /// Angle: the value is a raw position. Byte 1 is 3.
    Position,
}

/// A mode byte other than 1, 2 and 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownMode(pub u8);

impl Mode {
    /// The three of combined frames, in the order of their bytes.
    pub const ALL: [Self; 3] = [Self::Current, Self::Velocity, Self::Position];

    /// The byte of this mode in replies and mode switches.
    #[must_use]
    pub const fn byte(self) -> u8 {
        match self {
            Self::OpenLoop => 0,
            Self::Current => 1,
            Self::Velocity => 2,
            Self::Position => 3,
        }
    }

    /// The mode of this byte in combined frames.
    ///
    /// # Errors
    /// Returns a byte that is not a mode.
    pub const fn from_byte(byte: u8) -> Result<Self, UnknownMode> {
        match byte {
            1 => Ok(Self::Current),
            2 => Ok(Self::Velocity),
            3 => Ok(Self::Position),
            other => Err(UnknownMode(other)),
        }
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OpenLoop => "open loop",
            Self::Current => "current loop",
            Self::Velocity => "velocity loop",
            Self::Position => "position loop",
        })
    }
}

impl fmt::Display for UnknownMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "mode byte is {:02X}; expected 01 (current), 02 (velocity) or 03 (position)",
            self.0
        )
    }
}

impl core::error::Error for UnknownMode {}
