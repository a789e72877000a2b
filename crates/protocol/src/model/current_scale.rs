//! The unit of the current on the wire.

/// What a raw current of full scale, 32767, means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CurrentScale {
    milliamps: u16,
    certain: bool,
}

impl CurrentScale {
    /// Full scale is this many milliamps.
    #[must_use]
    pub const fn of(milliamps: u16) -> Self {
        Self {
            milliamps,
            certain: true,
        }
    }

    /// Sources disagree. `milliamps` is the largest full scale that one of them gives, so that a
    /// limit in amps holds whichever is right.
    #[must_use]
    pub const fn disputed(milliamps: u16) -> Self {
        Self {
            milliamps,
            certain: false,
        }
    }

    /// Milliamps at full scale; an upper bound if they are not certain.
    #[must_use]
    pub const fn milliamps(self) -> u16 {
        self.milliamps
    }

    /// Whether the sources agree. If not, show the raw number and say so.
    #[must_use]
    pub const fn is_certain(self) -> bool {
        self.certain
    }

    pub(crate) fn amps(self) -> f32 {
        f32::from(self.milliamps) / 1_000.0
    }
}
