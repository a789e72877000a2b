//! Commanded values. Their types keep them in range.

use core::fmt;

use crate::measured::{Current, Position, Rpm, nearest_i16, sign};

/// A value outside its range. The text names the range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfRange {
    /// The value.
    pub value: i32,
    /// Least allowed value.
    pub min: i32,
    /// Greatest allowed value.
    pub max: i32,
    /// The quantity with its unit.
    pub quantity: &'static str,
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            value,
            min,
            max,
            quantity,
        } = self;
        write!(f, "{quantity} must be {min} to {max}, not {value}")
    }
}

impl core::error::Error for OutOfRange {}

pub(crate) const fn checked(
    value: i32,
    min: i32,
    max: i32,
    quantity: &'static str,
) -> Result<i32, OutOfRange> {
    if value < min || value > max {
        Err(OutOfRange {
            value,
            min,
            max,
            quantity,
        })
    } else {
        Ok(value)
    }
}

/// A commanded speed, -380 to 380 rpm: the range of the fastest model, a DDSM400.
///
/// Each model has a range of its own ([`Spec::speed_rpm_max`](crate::family::Spec::speed_rpm_max)). That of a
/// DDSM115 is 330 rpm (the maker's manual), which it does not reach: at 18 V it runs at about 200 rpm without load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "i32", into = "i32"))]
pub struct SpeedTarget(i16);

impl SpeedTarget {
    /// Least target in rpm.
    pub const MIN: i32 = -380;
    /// Greatest target in rpm.
    pub const MAX: i32 = 380;
    /// 0 rpm: hold still. Not the same as stopping.
    pub const ZERO: Self = Self(0);

    /// A target in rpm.
    ///
    /// # Errors
    /// Outside -380..=380.
    pub const fn new(rpm: i32) -> Result<Self, OutOfRange> {
        match checked(rpm, Self::MIN, Self::MAX, "speed in rpm") {
            Ok(rpm) => Ok(Self::clamped(rpm)),
            Err(error) => Err(error),
        }
    }

    /// The nearest target to this many rpm.
    #[must_use]
    #[allow(
        clippy::cast_possible_truncation,
        reason = "the value was clamped to a range inside i16"
    )]
    pub const fn clamped(rpm: i32) -> Self {
        Self(if rpm < Self::MIN {
            Self::MIN as i16
        } else if rpm > Self::MAX {
            Self::MAX as i16
        } else {
            rpm as i16
        })
    }

    /// Revolutions a minute.
    #[must_use]
    pub const fn rpm(self) -> i16 {
        self.0
    }
}

// A commanded value that has the same range in both directions, as a raw number.
macro_rules! raw_target {
    ($(#[$doc:meta])* $name:ident, $quantity:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(try_from = "i32", into = "i32"))]
        pub struct $name(i16);

        impl $name {
            /// Least raw target.
            pub const MIN: i32 = -32767;
            /// Greatest raw target.
            pub const MAX: i32 = 32767;
            /// No current, or no voltage.
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
                match checked(raw, Self::MIN, Self::MAX, $quantity) {
                    Ok(raw) => Ok(Self(raw as i16)),
                    Err(error) => Err(error),
                }
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
    };
}

raw_target! {
    /// A commanded torque current, raw -32767 to 32767 = -8 A to 8 A.
    CurrentTarget, "raw current"
}

raw_target! {
    /// The share of the supply that the open loop puts on the windings, raw -32767 to 32767.
    ///
    /// No controller limits the speed then, so a small value may turn a free wheel fast.
    OpenLoopTarget, "raw open-loop value"
}

impl CurrentTarget {
    /// Milliamps of the greatest raw number, as of a [`Current`].
    pub const FULL_SCALE_MA: i32 = 8_000;

    /// The nearest target to this many amps; not a number is 0 A.
    #[must_use]
    pub fn from_amps(amps: f32) -> Self {
        Self(Current::from_amps(amps).raw().max(-i16::MAX))
    }

    /// Amps.
    #[must_use]
    pub fn amps(self) -> f32 {
        Current::from_raw(self.0).amps()
    }
}

impl OpenLoopTarget {
    /// The target of a value on the wire. -32768 has no positive counterpart.
    #[must_use]
    pub const fn nearest(raw: i16) -> Self {
        Self(if raw == i16::MIN { -i16::MAX } else { raw })
    }
}

/// A commanded angle, raw 0 to 32767 = 0 to 360 degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "i32", into = "i32"))]
pub struct PositionTarget(u16);

impl PositionTarget {
    /// Least raw target.
    pub const MIN: i32 = 0;
    /// Greatest raw target.
    pub const MAX: i32 = 32767;

    /// A raw target.
    ///
    /// # Errors
    /// Outside 0..=32767.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the value was checked to be inside 0..=32767"
    )]
    pub const fn new(raw: i32) -> Result<Self, OutOfRange> {
        match checked(raw, Self::MIN, Self::MAX, "raw position") {
            Ok(raw) => Ok(Self(raw as u16)),
            Err(error) => Err(error),
        }
    }

    /// The nearest target to an angle of 0 to 360 degrees; outside it, the nearer end.
    #[must_use]
    pub fn from_degrees(degrees: f32) -> Self {
        Self(nearest_i16(degrees * 32767.0 / 360.0).max(0).unsigned_abs())
    }

    /// The raw number.
    #[must_use]
    pub const fn raw(self) -> u16 {
        self.0
    }

    /// Degrees.
    #[must_use]
    pub fn degrees(self) -> f32 {
        Position::from_raw(self.0).degrees()
    }
}

/// A reported position above full scale is held at full scale.
impl From<Position> for PositionTarget {
    fn from(position: Position) -> Self {
        Self(position.raw().min(i16::MAX.unsigned_abs()))
    }
}

macro_rules! through_i32 {
    ($($type:ty),*) => {$(
        impl TryFrom<i32> for $type {
            type Error = OutOfRange;

            fn try_from(value: i32) -> Result<Self, Self::Error> {
                Self::new(value)
            }
        }

        impl From<$type> for i32 {
            fn from(target: $type) -> Self {
                target.0.into()
            }
        }
    )*};
}
through_i32!(SpeedTarget, CurrentTarget, PositionTarget, OpenLoopTarget);

/// Byte 6 of a drive frame in the velocity loop: a time per rpm, so *larger is gentler*.
///
/// About 3.6 ms per rpm per unit plus 60 ms (measured on real units). 0 means the default, which is
/// 1, the fastest. 3-5 is soft; at 20 the wheel reaches 41 rpm in 3 s. It does nothing on the way
/// down. Range 0-255.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Acceleration(u8);

impl Acceleration {
    /// The motor's own default, which is its fastest.
    pub const DEFAULT: Self = Self(0);
    /// The default, said aloud.
    pub const FASTEST: Self = Self(1);

    /// From the byte.
    #[must_use]
    pub const fn new(byte: u8) -> Self {
        Self(byte)
    }

    /// The byte.
    #[must_use]
    pub const fn byte(self) -> u8 {
        self.0
    }
}

impl fmt::Display for SpeedTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Rpm::new(self.0).fmt(f)
    }
}

impl fmt::Display for CurrentTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Current::from_raw(self.0).fmt(f)
    }
}

impl fmt::Display for PositionTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Position::from_raw(self.0).fmt(f)
    }
}

/// `+12.5 %`, of full scale.
impl fmt::Display for OpenLoopTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let per_mille = (i32::from(self.0.unsigned_abs()) * 1_000 + Self::MAX / 2) / Self::MAX;
        let sign = sign(self.0);
        write!(f, "{sign}{}.{} %", per_mille / 10, per_mille % 10)
    }
}
