//! The fault byte of every model.

use core::fmt;

use crate::{fault::Fault, model::Model};

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

    /// The model that names them.
    #[must_use]
    pub const fn model(self) -> Model {
        self.model
    }

    /// The faults of both sets, by the names of the other one.
    #[must_use]
    pub const fn joined(self, other: Self) -> Self {
        Self::of(other.model, self.byte | other.byte)
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
