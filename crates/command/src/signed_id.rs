//! A motor of `--id`.

use std::{fmt, str::FromStr};

use motorlink_bus::Mirror;
use motorlink_protocol::MotorId;

/// A motor, and whether its wheel is mounted the other way round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignedId {
    /// The motor.
    pub id: MotorId,
    /// Its side.
    pub mirror: Mirror,
}

impl SignedId {
    /// A motor that is not mirrored.
    #[must_use]
    pub const fn straight(id: MotorId) -> Self {
        Self {
            id,
            mirror: Mirror::Straight,
        }
    }
}

impl FromStr for SignedId {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let (digits, mirror) = match text.strip_prefix('-') {
            Some(digits) => (digits, Mirror::Mirrored),
            None => (text, Mirror::Straight),
        };
        let id = digits.parse().map_err(|error| format!("{error}"))?;
        Ok(Self { id, mirror })
    }
}

/// `0x02`, or `-0x02` if mirrored.
impl fmt::Display for SignedId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.mirror.is_mirrored() { "-" } else { "" };
        write!(f, "{sign}{}", self.id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_with_a_minus_is_mirrored() {
        let parsed: SignedId = "-0x02".parse().unwrap();
        assert_eq!((parsed.id.get(), parsed.mirror), (2, Mirror::Mirrored));
        assert!("0".parse::<SignedId>().is_err());
        assert!("--2".parse::<SignedId>().is_err());
    }
}
