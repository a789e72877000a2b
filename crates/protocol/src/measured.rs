//! Reported values: everything that the wire can carry, with the unit in the type.

use core::fmt;

/// Raw full scale of current and fine position.
const FULL_SCALE: f32 = 32767.0;
/// Amps at raw full scale.
const FULL_SCALE_AMPS: f32 = 8.0;
/// Degrees at full scale of either position.
const FULL_SCALE_DEGREES: f32 = 360.0;
/// Full scale of the one-byte position of a feedback query.
const COARSE_FULL_SCALE: f32 = 255.0;
/// The same full scales as whole numbers, for what is written: see [`Scaled`].
const FULL_SCALE_RAW: u32 = 32767;
const COARSE_FULL_SCALE_RAW: u32 = 255;

/// Speed in revolutions a minute; positive makes the reported angle fall.
///
/// Resolution 1 rpm. What may be *commanded* is a [`SpeedTarget`](crate::SpeedTarget).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rpm(i16);

impl Rpm {
    /// A reported speed.
    #[must_use]
    pub const fn new(rpm: i16) -> Self {
        Self(rpm)
    }

    /// Revolutions a minute, signed.
    #[must_use]
    pub const fn rpm(self) -> i16 {
        self.0
    }

    /// Revolutions a minute without direction.
    #[must_use]
    pub const fn magnitude(self) -> u16 {
        self.0.unsigned_abs()
    }

    /// Degrees a second that the *reported angle* moves: it falls at positive speed.
    #[must_use]
    pub fn degrees_per_second(self) -> f32 {
        f32::from(self.0) * -6.0
    }
}

/// Torque current as the wire carries it: amps = raw x 8 / 32767.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Current(i16);

impl Current {
    /// From the raw number.
    #[must_use]
    pub const fn from_raw(raw: i16) -> Self {
        Self(raw)
    }

    /// The nearest raw number to this many amps; beyond full scale, full scale. Not a number is 0 A.
    #[must_use]
    pub fn from_amps(amps: f32) -> Self {
        Self(nearest_i16(amps * FULL_SCALE / FULL_SCALE_AMPS))
    }

    /// The raw number.
    #[must_use]
    pub const fn raw(self) -> i16 {
        self.0
    }

    /// Amps, signed.
    #[must_use]
    pub fn amps(self) -> f32 {
        f32::from(self.0) * FULL_SCALE_AMPS / FULL_SCALE
    }

    /// The size in amps without direction, to three decimals.
    #[must_use]
    pub const fn scaled(self) -> Scaled<3> {
        Scaled::of(self.0.unsigned_abs() as u32 * 8_000, FULL_SCALE_RAW)
    }
}

/// The fine angle of a drive reply: degrees = raw x 360 / 32767.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Position(u16);

impl Position {
    /// From the raw number; a motor reports 0-32767.
    #[must_use]
    pub const fn from_raw(raw: u16) -> Self {
        Self(raw)
    }

    /// The raw number.
    #[must_use]
    pub const fn raw(self) -> u16 {
        self.0
    }

    /// Degrees, 0-360 for every raw number that a motor reports.
    #[must_use]
    pub fn degrees(self) -> f32 {
        f32::from(self.0) * FULL_SCALE_DEGREES / FULL_SCALE
    }

    /// Degrees to two decimals, about the resolution of the wire.
    #[must_use]
    pub const fn scaled(self) -> Scaled<2> {
        Scaled::of(self.0 as u32 * 36_000, FULL_SCALE_RAW)
    }
}

/// The one-byte angle of a query reply: degrees = raw x 360 / 255, steps of 1.4 degrees.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CoarsePosition(u8);

impl CoarsePosition {
    /// From the raw number.
    #[must_use]
    pub const fn from_raw(raw: u8) -> Self {
        Self(raw)
    }

    /// The raw number.
    #[must_use]
    pub const fn raw(self) -> u8 {
        self.0
    }

    /// Degrees, 0-360.
    #[must_use]
    pub fn degrees(self) -> f32 {
        f32::from(self.0) * FULL_SCALE_DEGREES / COARSE_FULL_SCALE
    }

    /// Degrees to one decimal.
    #[must_use]
    pub const fn scaled(self) -> Scaled<1> {
        Scaled::of(self.0 as u32 * 3_600, COARSE_FULL_SCALE_RAW)
    }
}

/// The angle of a reply, as fine as it is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angle {
    /// Of a drive or odometry reply.
    Fine(Position),
    /// Of a query reply.
    Coarse(CoarsePosition),
}

impl Angle {
    /// Degrees, 0 to 360.
    #[must_use]
    pub fn degrees(self) -> f32 {
        match self {
            Self::Fine(position) => position.degrees(),
            Self::Coarse(position) => position.degrees(),
        }
    }
}

/// Winding temperature in degrees Celsius, 0-255.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Celsius(u8);

impl Celsius {
    /// Degrees Celsius.
    #[must_use]
    pub const fn new(degrees: u8) -> Self {
        Self(degrees)
    }

    /// Degrees Celsius.
    #[must_use]
    pub const fn degrees(self) -> u8 {
        self.0
    }
}

/// Rounds half away from zero and saturates; `core` has no `round`.
#[allow(
    clippy::cast_possible_truncation,
    reason = "a float cast saturates, which is what is meant"
)]
pub(crate) fn nearest_i16(value: f32) -> i16 {
    (if value < 0.0 {
        value - 0.5
    } else {
        value + 0.5
    }) as i16
}

/// An unsigned quantity with this many decimals, for display: `1.250`.
///
/// It is the exact quotient rounded to the nearest last digit, by whole numbers only: a log of a
/// million rows is written in seconds, and no program carries the formatting of floats for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scaled<const DECIMALS: usize> {
    /// The digits before the point.
    pub whole: u32,
    /// The digits after the point, as a number below 10 to the power of the decimals.
    pub fraction: u32,
}

impl<const DECIMALS: usize> Scaled<DECIMALS> {
    /// The nearest to `dividend` / `divisor` in units of the last decimal. The divisors here are odd,
    /// so nothing is ever half way.
    pub(crate) const fn of(dividend: u32, divisor: u32) -> Self {
        let mut unit = 1;
        let mut decimal = 0;
        while decimal < DECIMALS {
            unit *= 10;
            decimal += 1;
        }
        let nearest = (dividend + divisor / 2) / divisor;
        Self {
            whole: nearest / unit,
            fraction: nearest % unit,
        }
    }
}

impl<const DECIMALS: usize> fmt::Display for Scaled<DECIMALS> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{:0DECIMALS$}", self.whole, self.fraction)
    }
}

/// The sign of a number, always shown, with a real minus, as the page shows all of them.
pub(crate) const fn sign(value: i16) -> char {
    if value < 0 { '\u{2212}' } else { '+' }
}

/// `+100 rpm`
impl fmt::Display for Rpm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{} rpm", sign(self.0), self.magnitude())
    }
}

/// `+0.175 A`
impl fmt::Display for Current {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{} A", sign(self.0), self.scaled())
    }
}

/// `66.96°`
impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}°", self.scaled())
    }
}

/// `347.3°`
impl fmt::Display for CoarsePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}°", self.scaled())
    }
}

/// `66.96°` or `347.3°`
impl fmt::Display for Angle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fine(position) => position.fmt(f),
            Self::Coarse(position) => position.fmt(f),
        }
    }
}

/// `32 °C`
impl fmt::Display for Celsius {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} °C", self.0)
    }
}

macro_rules! debug_as_display {
    ($($type:ty),*) => {$(
        impl fmt::Debug for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Display::fmt(self, f)
            }
        }
    )*};
}
debug_as_display!(Rpm, Current, Position, CoarsePosition, Celsius);
