//! Setpoints of the open loop.

use core::fmt;

use crate::{
    measured::sign,
    target::{OutOfRange, checked, through_i32},
};

/// The share of the supply that the open loop puts on the windings, raw -32767 to 32767.
///
/// No controller limits the speed then, so a small value may turn a free wheel fast.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "i32", into = "i32"))]
pub struct OpenLoopTarget(i16);

impl OpenLoopTarget {
    /// Least raw target.
    pub const MIN: i32 = -32767;
    /// Greatest raw target.
    pub const MAX: i32 = 32767;
    /// No voltage.
    pub const ZERO: Self = Self(0);

    /// A raw target.
    ///
    /// # Errors
    /// Outside -32767..=32767.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "the value was checked to be inside i16"
    )]
    pub const fn new(raw: i32) -> Result<Self, OutOfRange> {
        match checked(raw, Self::MIN, Self::MAX, "raw open-loop value") {
            Ok(raw) => Ok(Self(raw as i16)),
            Err(error) => Err(error),
        }
    }

    /// The target of a value on the wire. -32768 has no positive counterpart.
    #[must_use]
    pub const fn nearest(raw: i16) -> Self {
        Self(if raw == i16::MIN { -i16::MAX } else { raw })
    }

    /// The raw number.
    #[must_use]
    pub const fn raw(self) -> i16 {
        self.0
    }

    /// The same value in the other direction.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self(-self.0)
    }
}

through_i32!(OpenLoopTarget);

/// `+12.5 %`, of full scale.
impl fmt::Display for OpenLoopTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let per_mille = (i32::from(self.0.unsigned_abs()) * 1_000 + Self::MAX / 2) / Self::MAX;
        let sign = sign(self.0);
        write!(f, "{sign}{}.{} %", per_mille / 10, per_mille % 10)
    }
}
