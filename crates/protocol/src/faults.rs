//! Byte 8 of a reply.

use core::fmt;

/// A protection or defect that the motor reports.
///
/// | bit | fault | trips at | clears |
/// |---|---|---|---|
/// | 0 | sensor | encoder defect | not known |
/// | 1 | bus overcurrent | 3 A | after 5 s |
/// | 2 | phase overcurrent | 4.6 A | after 5 s |
/// | 3 | stall | blocked over 5 s | after 5 s |
/// | 4 | over-temperature | 80 °C | below 75 °C |
///
/// Source: the maker's manual. One published table calls bit 4 "troubleshooting".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// The encoder fails.
    Sensor,
    /// More than 3 A from the supply.
    BusOvercurrent,
    /// More than 4.6 A in a phase.
    PhaseOvercurrent,
    /// The wheel was blocked for more than 5 s.
    Stall,
    /// The winding reached 80 °C.
    OverTemperature,
}

impl Fault {
    /// All of them, in the order of their bits.
    pub const ALL: [Self; 5] = [
        Self::Sensor,
        Self::BusOvercurrent,
        Self::PhaseOvercurrent,
        Self::Stall,
        Self::OverTemperature,
    ];

    /// Its bit in byte 8.
    #[must_use]
    pub const fn mask(self) -> u8 {
        match self {
            Self::Sensor => 1,
            Self::BusOvercurrent => 1 << 1,
            Self::PhaseOvercurrent => 1 << 2,
            Self::Stall => 1 << 3,
            Self::OverTemperature => 1 << 4,
        }
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sensor => "sensor",
            Self::BusOvercurrent => "bus overcurrent",
            Self::PhaseOvercurrent => "phase overcurrent",
            Self::Stall => "stall",
            Self::OverTemperature => "over-temperature",
        }
    }
}

/// The fault byte: every fault that is active. Reserved bits are kept as they came.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Faults(u8);

impl Faults {
    /// No fault.
    pub const NONE: Self = Self(0);

    /// Every bit that has a name.
    const NAMED: u8 = 0b0001_1111;

    /// From byte 8.
    #[must_use]
    pub const fn from_byte(byte: u8) -> Self {
        Self(byte)
    }

    /// Byte 8 as it came.
    #[must_use]
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Whether byte 8 is zero.
    #[must_use]
    pub const fn is_none(self) -> bool {
        self.0 == 0
    }

    /// Whether a fault that has a name is active. Reserved bits say nothing that one could act on.
    #[must_use]
    pub const fn any_named(self) -> bool {
        self.0 & Self::NAMED != 0
    }

    /// Whether this fault is active.
    #[must_use]
    pub const fn contains(self, fault: Fault) -> bool {
        self.0 & fault.mask() != 0
    }

    /// This set with one more fault.
    #[must_use]
    pub const fn with(self, fault: Fault) -> Self {
        Self(self.0 | fault.mask())
    }

    /// This set without one fault.
    #[must_use]
    pub const fn without(self, fault: Fault) -> Self {
        Self(self.0 & !fault.mask())
    }

    /// The active faults in the order of their bits.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        Fault::ALL
            .into_iter()
            .filter(move |fault| self.contains(*fault))
    }

    /// Bits that are set but have no name, 0 if none.
    #[must_use]
    pub const fn unknown_bits(self) -> u8 {
        self.0 & !Self::NAMED
    }
}

/// `OK`, or `stall, over-temperature`, or `unknown bits 0x20`.
impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_none() {
            return f.write_str("OK");
        }
        let mut separator = "";
        for fault in self.iter() {
            write!(f, "{separator}{}", fault.name())?;
            separator = ", ";
        }
        if self.unknown_bits() != 0 {
            write!(f, "{separator}unknown bits 0x{:02X}", self.unknown_bits())?;
        }
        Ok(())
    }
}

impl fmt::Debug for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self} (0x{:02X})", self.0)
    }
}
