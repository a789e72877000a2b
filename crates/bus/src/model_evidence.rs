//! What replies tell about the model of the motors.

use std::time::Duration;

use motorlink_protocol::{Instant, family::Model};

/// Two frames within this time show another model. One alone may be noise: about one in 256 garbled frames has a
/// good CRC.
const WITHIN: Duration = Duration::from_secs(1);

/// What replies have told about the model of the motors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ModelEvidence {
    /// Whether a motor has answered as the model of the line.
    pub(crate) own: bool,
    /// The other model that the replies show.
    pub(crate) other: Option<Model>,
    /// The last frame of another model.
    last: Option<(Instant, Model)>,
}

impl ModelEvidence {
    /// Records a frame of another model. Returns whether the replies show that model from now on.
    pub(crate) fn other_reply(&mut self, now: Instant, found: Model) -> bool {
        let before = self.last.replace((now, found));
        let again = before.is_some_and(|(at, model)| model == found && now.since(at) <= WITHIN);
        let is_new = again && self.other.is_none();
        if is_new {
            self.other = Some(found);
        }
        is_new
    }
}
