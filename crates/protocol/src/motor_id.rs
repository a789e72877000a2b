//! Addresses on the bus.

use core::fmt;

/// First byte of the ID query. A motor may have it as its address, but no motor should get it.
const ID_QUERY_BYTE: u8 = 0xC8;

/// The address of a motor: 1 to 254.
///
/// 200 (0xC8) is an address like any other when spoken to, but it is also the first byte of the ID
/// query that every motor hears, so it cannot be assigned: see [`AssignableId`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "u8", into = "u8"))]
pub struct MotorId(u8);

/// Why a number is no motor's address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorIdError {
    /// Address 0 is not used.
    Zero,
    /// Above 254. The number does not fit when it was above 255.
    TooLarge,
}

impl MotorId {
    /// The lowest address, which a new motor has.
    pub const FIRST: Self = Self(1);
    /// The highest address.
    pub const LAST: Self = Self(254);

    /// The motor with this address.
    ///
    /// # Errors
    /// Names the rule that 0 and 255 break.
    pub const fn new(address: u8) -> Result<Self, MotorIdError> {
        match address {
            0 => Err(MotorIdError::Zero),
            255 => Err(MotorIdError::TooLarge),
            _ => Ok(Self(address)),
        }
    }

    /// The address, 1-254.
    #[must_use]
    pub const fn get(self) -> u8 {
        self.0
    }

    /// Every address in rising order.
    pub fn all() -> impl DoubleEndedIterator<Item = Self> {
        (Self::FIRST.0..=Self::LAST.0).map(Self)
    }

    /// Whether the bare zero drive frame to this address is the ID query, which all motors answer.
    #[must_use]
    pub(crate) const fn is_id_query_byte(self) -> bool {
        self.0 == ID_QUERY_BYTE
    }
}

impl TryFrom<u8> for MotorId {
    type Error = MotorIdError;

    fn try_from(address: u8) -> Result<Self, Self::Error> {
        Self::new(address)
    }
}

impl From<MotorId> for u8 {
    fn from(id: MotorId) -> Self {
        id.0
    }
}

impl core::str::FromStr for MotorId {
    type Err = MotorIdError;

    /// Reads a decimal number or one in hex with `0x`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let text = text.trim();
        let hex = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
        let address = hex.map_or_else(
            || text.parse::<u8>(),
            |digits| u8::from_str_radix(digits, 16),
        );
        address
            .map_err(|_| MotorIdError::TooLarge)
            .and_then(Self::new)
    }
}

/// `0x01`, as the protocol's documents write it.
impl fmt::Display for MotorId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "0x{:02X}", self.0)
    }
}

impl fmt::Debug for MotorId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "motor {self}")
    }
}

impl fmt::Display for MotorIdError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Zero => "0 is not a valid ID: use 1 to 254",
            Self::TooLarge => "not a valid ID: use a whole number from 1 to 254",
        })
    }
}

impl core::error::Error for MotorIdError {}

/// An address that a motor may be given: any but 0xC8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "MotorId", into = "MotorId"))]
pub struct AssignableId(MotorId);

/// 0xC8 starts the ID query, which all motors answer: no motor may get it as its ID.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotAssignable;

impl AssignableId {
    /// The motor's future address.
    ///
    /// # Errors
    /// Refuses 0xC8.
    pub const fn new(id: MotorId) -> Result<Self, NotAssignable> {
        if id.is_id_query_byte() {
            Err(NotAssignable)
        } else {
            Ok(Self(id))
        }
    }

    /// The address.
    #[must_use]
    pub const fn id(self) -> MotorId {
        self.0
    }
}

impl TryFrom<MotorId> for AssignableId {
    type Error = NotAssignable;

    fn try_from(id: MotorId) -> Result<Self, Self::Error> {
        Self::new(id)
    }
}

impl From<AssignableId> for MotorId {
    fn from(id: AssignableId) -> Self {
        id.0
    }
}

impl fmt::Display for NotAssignable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("200 (0xC8) is reserved for the ID query: use another ID")
    }
}

impl core::error::Error for NotAssignable {}
