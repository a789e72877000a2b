//! Speeds in tenths of an rpm, the finest unit that a model has on the wire.

use core::fmt;

use crate::{measured::sign, model::Model};

/// A reported speed. At positive speed the angle of a DDSM115 falls; of the models with separate frames
/// no source says what it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Speed {
    tenths: i32,
}

impl Speed {
    /// A speed in tenths of a revolution a minute.
    #[must_use]
    pub const fn from_tenths(tenths: i32) -> Self {
        Self { tenths }
    }

    /// Tenths of a revolution a minute, signed.
    #[must_use]
    pub const fn tenths(self) -> i32 {
        self.tenths
    }

    /// Whole revolutions a minute without direction, rounded down: 0 is under 1 rpm.
    #[must_use]
    pub const fn magnitude(self) -> u32 {
        self.tenths.unsigned_abs() / 10
    }
}

impl Model {
    /// A speed that was read from the wire.
    #[must_use]
    pub fn speed_of_raw(self, raw: i16) -> Speed {
        Speed::from_tenths(i32::from(raw) * self.tenths_per_unit())
    }

    /// A speed in the unit of the wire: the nearest that it can carry.
    #[must_use]
    #[allow(
        clippy::cast_possible_truncation,
        reason = "the value was compared with the bounds of the type"
    )]
    pub const fn raw_of_speed(self, speed: Speed) -> i16 {
        let unit = self.tenths_per_unit();
        let half = if speed.tenths < 0 {
            -(unit / 2)
        } else {
            unit / 2
        };
        let raw = speed.tenths.saturating_add(half) / unit;
        if raw > i16::MAX as i32 {
            i16::MAX
        } else if raw < i16::MIN as i32 {
            i16::MIN
        } else {
            raw as i16
        }
    }

    const fn tenths_per_unit(self) -> i32 {
        10 / self.spec().speed_units_per_rpm as i32
    }
}

/// `+100 rpm`, `+0.5 rpm`
impl fmt::Display for Speed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.tenths.unsigned_abs();
        let sign = if self.tenths < 0 { sign(-1) } else { sign(0) };
        write!(f, "{sign}{}", size / 10)?;
        if !size.is_multiple_of(10) {
            write!(f, ".{}", size % 10)?;
        }
        f.write_str(" rpm")
    }
}
