//! Virtual motors in this process.

use motorlink_protocol::{MotorId, family::Model};
use motorlink_simulator::WorldConfig;

/// Virtual motors.
#[derive(Clone, Debug)]
pub struct VirtualLine {
    /// Their initial state.
    pub world: WorldConfig,
}

impl VirtualLine {
    /// Motors of this model with these IDs, at rest on a faultless wire.
    #[must_use]
    pub fn of(model: Model, ids: impl IntoIterator<Item = MotorId>) -> Self {
        Self {
            world: WorldConfig::of(model, ids),
        }
    }

    /// The model of its motors.
    pub(crate) fn model(&self) -> Model {
        let first = self.world.motors.first();
        first.map_or(Model::Ddsm115, |motor| motor.model)
    }
}
