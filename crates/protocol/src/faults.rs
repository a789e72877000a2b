//! The fault byte of every model.

use core::fmt;

use crate::family::Model;

/// A protection or defect that a motor reports.
///
/// | bit | DDSM115, DDSM315 | DDSM210 | DDSM400 |
/// |---|---|---|---|
/// | 0 | sensor | | sensor |
/// | 1 | bus overcurrent | overcurrent | overcurrent |
/// | 2 | phase overcurrent | | |
/// | 3 | stall | | stall |
/// | 4 | over-temperature | over-temperature | over-temperature |
/// | 5 | | | disconnected |
/// | 6 | | | over- or undervoltage |
///
/// Source: the maker's manual for the DDSM115, two clients for the others. One published table calls bit 4
/// of a DDSM115 "troubleshooting".
///
/// | of a DDSM115 | trips at | clears |
/// |---|---|---|
/// | sensor | encoder defect | not known |
/// | bus overcurrent | 3 A | after 5 s |
/// | phase overcurrent | 4.6 A | after 5 s |
/// | stall | blocked over 5 s | after 5 s |
/// | over-temperature | 80 °C | below 75 °C |
///
/// When a protection of the others trips and clears is not published, except the 80 °C of a DDSM210.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// The encoder fails.
    Sensor,
    /// The supply current is too high.
    BusOvercurrent,
    /// A phase current is too high.
    PhaseOvercurrent,
    /// Too much current, of the supply or of a phase.
    Overcurrent,
    /// The wheel is blocked.
    Stall,
    /// The winding is too hot.
    OverTemperature,
    /// The motor reports that it is disconnected. No source says from what.
    Disconnected,
    /// The supply voltage is too high or too low.
    Voltage,
}

impl Fault {
    /// Its bit in the fault byte.
    #[must_use]
    pub const fn mask(self) -> u8 {
        match self {
            Self::Sensor => 1,
            Self::BusOvercurrent | Self::Overcurrent => 1 << 1,
            Self::PhaseOvercurrent => 1 << 2,
            Self::Stall => 1 << 3,
            Self::OverTemperature => 1 << 4,
            Self::Disconnected => 1 << 5,
            Self::Voltage => 1 << 6,
        }
    }

    /// Short name, in lower case.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sensor => "sensor",
            Self::BusOvercurrent => "bus overcurrent",
            Self::PhaseOvercurrent => "phase overcurrent",
            Self::Overcurrent => "overcurrent",
            Self::Stall => "stall",
            Self::OverTemperature => "over-temperature",
            Self::Disconnected => "disconnected",
            Self::Voltage => "over- or undervoltage",
        }
    }
}

impl Default for Faults {
    fn default() -> Self {
        Self::NONE
    }
}

/// The fault byte: every fault that is active, by the names of the model. Bits without a name are kept
/// as they came.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Faults {
    byte: u8,
    model: Model,
}

impl Faults {
    /// No fault.
    pub const NONE: Self = Self::from_byte(0);

    /// From the fault byte of a DDSM115.
    #[must_use]
    pub const fn from_byte(byte: u8) -> Self {
        Self::of(Model::Ddsm115, byte)
    }

    /// From the fault byte of this model.
    #[must_use]
    pub const fn of(model: Model, byte: u8) -> Self {
        Self { byte, model }
    }

    /// The fault byte as it came.
    #[must_use]
    pub const fn byte(self) -> u8 {
        self.byte
    }

    /// Whether the fault byte is zero.
    #[must_use]
    pub const fn is_none(self) -> bool {
        self.byte == 0
    }

    /// Whether a fault that has a name is active.
    #[must_use]
    pub fn any_named(self) -> bool {
        self.iter().next().is_some()
    }

    /// Whether this fault is active. A model without it never has it.
    #[must_use]
    pub fn contains(self, fault: Fault) -> bool {
        self.iter().any(|active| active == fault)
    }

    /// This set with one more fault.
    #[must_use]
    pub const fn with(self, fault: Fault) -> Self {
        Self::of(self.model, self.byte | fault.mask())
    }

    /// This set without one fault.
    #[must_use]
    pub const fn without(self, fault: Fault) -> Self {
        Self::of(self.model, self.byte & !fault.mask())
    }

    /// The active faults in the order of their bits.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        let all = self.model.spec().faults.iter().copied();
        all.filter(move |fault| self.byte & fault.mask() != 0)
    }

    /// Bits that are set but have no name, 0 if none.
    #[must_use]
    pub fn unknown_bits(self) -> u8 {
        self.iter()
            .fold(self.byte, |rest, fault| rest & !fault.mask())
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
        write!(f, "{self} (0x{:02X})", self.byte)
    }
}
