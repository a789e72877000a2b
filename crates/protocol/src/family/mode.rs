//! The loops of every model.

use core::fmt;

/// The active loop, which decides how the value of a drive frame is read. [`Model::modes`](super::Model::modes) lists
/// the loops of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// No loop: the value is a share of the supply.
    OpenLoop,
    /// Torque: the value is a raw current.
    Current,
    /// Speed: the value is in the unit of the model.
    Velocity,
    /// Angle: the value is a raw position.
    Position,
}

impl Mode {
    /// The byte of this mode in mode switches and replies.
    #[must_use]
    pub const fn byte(self) -> u8 {
        match self {
            Self::OpenLoop => 0,
            Self::Current => 1,
            Self::Velocity => 2,
            Self::Position => 3,
        }
    }

    /// The closed loop; `None` in the open loop.
    #[must_use]
    pub const fn closed(self) -> Option<crate::Mode> {
        match self {
            Self::OpenLoop => None,
            Self::Current => Some(crate::Mode::Current),
            Self::Velocity => Some(crate::Mode::Velocity),
            Self::Position => Some(crate::Mode::Position),
        }
    }
}

impl From<crate::Mode> for Mode {
    fn from(mode: crate::Mode) -> Self {
        match mode {
            crate::Mode::Current => Self::Current,
            crate::Mode::Velocity => Self::Velocity,
            crate::Mode::Position => Self::Position,
        }
    }
}

/// `velocity loop`
impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.closed() {
            Some(mode) => mode.fmt(f),
            None => f.write_str("open loop"),
        }
    }
}
