//! The angle as the motor knows it.

use motorlink_protocol::{CoarsePosition, Position};

use crate::convert::{nearest_u8, nearest_u16};

/// Counts a turn (published).
const COUNTS: f64 = 4096.0;
/// Raw full scale of the fine position.
const FINE_FULL_SCALE: f64 = 32767.0;
/// Raw full scale of the coarse position.
const COARSE_FULL_SCALE: f64 = 255.0;

/// A reading of the encoder: whole counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Encoder {
    /// 0 up to 1 turn, less than 1, in steps of a count.
    turn: f64,
}

impl Encoder {
    /// Reads the wheel. The reported angle falls as the wheel turns at positive speed (captures: at
    /// +100 rpm it loses 600 degrees a second).
    pub(crate) fn read(turns: f64) -> Self {
        let count = ((-turns).rem_euclid(1.0) * COUNTS).floor();
        Self {
            turn: (count / COUNTS).rem_euclid(1.0),
        }
    }

    /// Reads the wheel of a model whose angle grows at positive speed.
    pub(crate) fn read_rising(turns: f64) -> Self {
        Self::read(-turns)
    }

    pub(crate) const fn degrees(self) -> f64 {
        self.turn * 360.0
    }

    pub(crate) fn fine(self) -> Position {
        Position::from_raw(nearest_u16(self.turn * FINE_FULL_SCALE))
    }

    pub(crate) fn coarse(self) -> CoarsePosition {
        CoarsePosition::from_raw(nearest_u8(self.turn * COARSE_FULL_SCALE))
    }
}
