//! Torque current: reported and commanded, with the scale of the model.

use core::fmt;

use crate::{
    measured::{Scaled, nearest_i16, sign},
    model::{CurrentScale, Model},
    target::{OutOfRange, checked},
};

/// Raw full scale.
const FULL_SCALE: f32 = 32767.0;
/// The same as a whole number, for what is written: see [`Scaled`].
const FULL_SCALE_RAW: u32 = 32767;

/// Torque current as the wire carries it: a raw number, and the [`CurrentScale`] of the model.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Current {
    raw: i16,
    scale: CurrentScale,
}

impl Current {
    /// The raw number.
    #[must_use]
    pub const fn raw(self) -> i16 {
        self.raw
    }

    /// What the raw number means.
    #[must_use]
    pub const fn scale(self) -> CurrentScale {
        self.scale
    }

    /// Amps, signed; an upper bound of their size if the scale is not certain.
    #[must_use]
    pub fn amps(self) -> f32 {
        f32::from(self.raw) * self.scale.amps() / FULL_SCALE
    }

    /// The size in amps without direction, to three decimals.
    #[must_use]
    pub const fn scaled(self) -> Scaled<3> {
        let full_scale = self.scale.milliamps() as u32;
        Scaled::of(self.raw.unsigned_abs() as u32 * full_scale, FULL_SCALE_RAW)
    }
}

/// A commanded torque current: a raw number from -32767 to 32767, and the scale of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CurrentTarget(Current);

impl CurrentTarget {
    /// Least raw target.
    pub const MIN: i32 = -32767;
    /// Greatest raw target.
    pub const MAX: i32 = 32767;

    /// The raw number.
    #[must_use]
    pub const fn raw(self) -> i16 {
        self.0.raw
    }

    /// What the raw number means.
    #[must_use]
    pub const fn scale(self) -> CurrentScale {
        self.0.scale
    }

    /// The same current in the other direction.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self(Current {
            raw: -self.0.raw,
            scale: self.0.scale,
        })
    }

    /// Amps.
    #[must_use]
    pub fn amps(self) -> f32 {
        self.0.amps()
    }
}

impl Model {
    /// A current that was read from the wire.
    #[must_use]
    pub const fn current_of_raw(self, raw: i16) -> Current {
        Current {
            raw,
            scale: self.spec().current,
        }
    }

    /// The nearest current to this many amps that the wire can carry. Not a number is 0 A.
    #[must_use]
    pub fn current_of_amps(self, amps: f32) -> Current {
        self.current_of_raw(nearest_i16(amps * FULL_SCALE / self.spec().current.amps()))
    }

    /// A raw target; 0 A lets the wheel coast.
    ///
    /// # Errors
    /// Outside -32767..=32767.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "the value was checked to be inside i16"
    )]
    pub const fn current(self, raw: i32) -> Result<CurrentTarget, OutOfRange> {
        match checked(raw, CurrentTarget::MIN, CurrentTarget::MAX, "raw current") {
            Ok(raw) => Ok(CurrentTarget(self.current_of_raw(raw as i16))),
            Err(error) => Err(error),
        }
    }
}

/// `+0.175 A`, or `raw +717` if the scale is not certain.
impl fmt::Display for Current {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = sign(self.raw);
        if self.scale.is_certain() {
            write!(f, "{sign}{} A", self.scaled())
        } else {
            write!(f, "raw {sign}{}", self.raw.unsigned_abs())
        }
    }
}

impl fmt::Display for CurrentTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Debug for Current {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
