//! Motors that are driven as one: a vehicle.

use std::fmt;

use motorlink_protocol::{MotorId, Setpoint};

/// A setpoint for each of several motors, which start together, stop together, and of which none goes
/// on without the others.
///
/// 1 to [`Together::MAX`] motors, each once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "Vec<(MotorId, Setpoint)>",
        into = "Vec<(MotorId, Setpoint)>"
    )
)]
pub struct Together([Option<(MotorId, Setpoint)>; Together::MAX]);

/// Why motors cannot be driven together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotTogether {
    /// There is none.
    Nobody,
    /// There are more than [`Together::MAX`].
    TooMany,
    /// One is named twice.
    Twice(MotorId),
}

impl Together {
    /// Most motors: twice of what a line can drive at 50 Hz.
    pub const MAX: usize = 16;

    /// These motors with these setpoints.
    ///
    /// # Errors
    /// [`NotTogether`] says what is wrong with them.
    pub fn new(parts: &[(MotorId, Setpoint)]) -> Result<Self, NotTogether> {
        let mut slots = [None; Self::MAX];
        if parts.is_empty() {
            return Err(NotTogether::Nobody);
        }
        if parts.len() > slots.len() {
            return Err(NotTogether::TooMany);
        }
        for (place, (slot, part)) in slots.iter_mut().zip(parts).enumerate() {
            let before = parts.iter().take(place);
            if before.into_iter().any(|(id, _)| *id == part.0) {
                return Err(NotTogether::Twice(part.0));
            }
            *slot = Some(*part);
        }
        Ok(Self(slots))
    }

    /// Every motor with its setpoint.
    pub fn parts(&self) -> impl Iterator<Item = (MotorId, Setpoint)> + '_ {
        self.0.iter().flatten().copied()
    }

    /// Whether this motor is among them.
    #[must_use]
    pub fn has(&self, id: MotorId) -> bool {
        self.parts().any(|(part, _)| part == id)
    }
}

impl TryFrom<Vec<(MotorId, Setpoint)>> for Together {
    type Error = NotTogether;

    fn try_from(parts: Vec<(MotorId, Setpoint)>) -> Result<Self, Self::Error> {
        Self::new(&parts)
    }
}

impl From<Together> for Vec<(MotorId, Setpoint)> {
    fn from(together: Together) -> Self {
        together.parts().collect()
    }
}

impl fmt::Display for NotTogether {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nobody => f.write_str("no motor is selected"),
            Self::TooMany => write!(f, "a group has at most {} motors", Together::MAX),
            Self::Twice(id) => write!(f, "motor {id} is listed twice"),
        }
    }
}

impl std::error::Error for NotTogether {}
