//! Reported torque current, with the scale of the model.

use core::fmt;

use crate::{
    measured::{Scaled, nearest_i16, sign},
    model::{CurrentScale, Model},
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

impl fmt::Debug for Current {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
