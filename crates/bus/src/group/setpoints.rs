//! The setpoints of a group: motors that are driven as one vehicle.

use motorlink_protocol::{MotorId, Setpoint};

/// A setpoint for each motor of a group. The motors start together and stop together.
///
/// 1 to [`GroupSetpoints::MAX`] motors, each once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "Vec<(MotorId, Setpoint)>",
        into = "Vec<(MotorId, Setpoint)>"
    )
)]
pub struct GroupSetpoints([Option<(MotorId, Setpoint)>; GroupSetpoints::MAX]);

/// Why motors cannot form a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GroupError {
    /// No motor.
    #[error("no motor is chosen")]
    Empty,
    /// More than [`GroupSetpoints::MAX`] motors.
    #[error("at most {} motors are driven together", GroupSetpoints::MAX)]
    TooMany,
    /// This motor appears twice.
    #[error("motor {0} is named twice")]
    Duplicate(MotorId),
}

impl GroupSetpoints {
    /// Most motors: twice as many as a line can drive at 50 Hz.
    pub const MAX: usize = 16;

    /// A group of these motors with these setpoints.
    ///
    /// # Errors
    /// [`GroupError`] names the rule that they break.
    pub fn new(entries: &[(MotorId, Setpoint)]) -> Result<Self, GroupError> {
        let mut slots = [None; Self::MAX];
        if entries.is_empty() {
            return Err(GroupError::Empty);
        }
        if entries.len() > slots.len() {
            return Err(GroupError::TooMany);
        }
        for (place, (slot, part)) in slots.iter_mut().zip(entries).enumerate() {
            let before = entries.iter().take(place);
            if before.into_iter().any(|(id, _)| *id == part.0) {
                return Err(GroupError::Duplicate(part.0));
            }
            *slot = Some(*part);
        }
        Ok(Self(slots))
    }

    /// Every motor with its setpoint.
    pub fn entries(&self) -> impl Iterator<Item = (MotorId, Setpoint)> + '_ {
        self.0.iter().flatten().copied()
    }

    /// The setpoint of this motor, if it is among them.
    #[inline(never)]
    pub(crate) fn of(&self, id: MotorId) -> Option<Setpoint> {
        let of_motor = |(member, setpoint)| (member == id).then_some(setpoint);
        self.entries().find_map(of_motor)
    }

    /// Whether this motor is among them.
    #[must_use]
    pub fn has(&self, id: MotorId) -> bool {
        self.of(id).is_some()
    }

    /// Whether the other one has the same motors, in any order.
    pub(crate) fn has_the_motors_of(&self, other: &Self) -> bool {
        self.entries().count() == other.entries().count()
            && self.entries().all(|(id, _)| other.has(id))
    }
}

impl TryFrom<Vec<(MotorId, Setpoint)>> for GroupSetpoints {
    type Error = GroupError;

    fn try_from(entries: Vec<(MotorId, Setpoint)>) -> Result<Self, Self::Error> {
        Self::new(&entries)
    }
}

impl From<GroupSetpoints> for Vec<(MotorId, Setpoint)> {
    fn from(together: GroupSetpoints) -> Self {
        together.entries().collect()
    }
}
