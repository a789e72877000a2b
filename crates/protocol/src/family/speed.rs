//! Speeds in tenths of an rpm, the finest unit that a model has on the wire.

use core::fmt;

use crate::{
    measured::sign,
    model::Model,
    target::{OutOfRange, checked},
};

/// A reported speed. At positive speed the angle of a DDSM115 falls; of the models with separate frames
/// no source says what it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Speed {
    tenths: i32,
}

/// A commanded speed, in the range of the model that made it: see [`Model::speed`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct SpeedTarget {
    tenths: i16,
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

impl SpeedTarget {
    /// 0 rpm: hold still. Not the same as stopping.
    pub const ZERO: Self = Self { tenths: 0 };

    /// Tenths of a revolution a minute, signed.
    #[must_use]
    pub const fn tenths(self) -> i16 {
        self.tenths
    }

    /// The same speed in the other direction.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self {
            tenths: -self.tenths,
        }
    }
}

impl Model {
    /// A target in tenths of an rpm.
    ///
    /// # Errors
    /// Beyond the range of the model.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "the value was checked to be inside i16"
    )]
    pub const fn speed(self, tenths: i32) -> Result<SpeedTarget, OutOfRange> {
        let most = self.speed_tenths_max() as i32;
        match checked(tenths, -most, most, "speed in tenths of an rpm") {
            Ok(tenths) => Ok(SpeedTarget {
                tenths: tenths as i16,
            }),
            Err(error) => Err(error),
        }
    }

    /// The nearest target in range to this many tenths of an rpm.
    #[must_use]
    pub fn speed_clamped(self, tenths: i32) -> SpeedTarget {
        let most = i32::from(self.speed_tenths_max());
        self.speed(tenths.max(-most).min(most)).unwrap_or_default()
    }

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

    pub(crate) const fn speed_tenths_max(self) -> i16 {
        self.spec().speed_rpm_max.cast_signed() * 10
    }
}

fn write(f: &mut fmt::Formatter<'_>, tenths: i32) -> fmt::Result {
    let size = tenths.unsigned_abs();
    let sign = if tenths < 0 { sign(-1) } else { sign(0) };
    write!(f, "{sign}{}", size / 10)?;
    if !size.is_multiple_of(10) {
        write!(f, ".{}", size % 10)?;
    }
    f.write_str(" rpm")
}

/// `+100 rpm`, `+0.5 rpm`
impl fmt::Display for Speed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write(f, self.tenths)
    }
}

impl fmt::Display for SpeedTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write(f, self.tenths.into())
    }
}
