//! Which model the replies on a line show.

use motorlink_protocol::{Instant, family::Model};

use crate::bus::Bus;

/// What the replies on a port show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DetectedModel {
    /// The model of the line.
    Own,
    /// Another model of the same baud rate.
    Other(Model),
}

impl Bus {
    /// The model that the replies so far show; `None` while there is none, and while a stop runs: to try another model,
    /// the caller closes the port.
    #[must_use]
    pub fn detected_model(&self, now: Instant) -> Option<DetectedModel> {
        if self.model_known() {
            return Some(DetectedModel::Own);
        }
        // One frame of another model is enough to try that model next: if it was noise, that trial shows it.
        let other = self.likely_model()?;
        (!self.is_active(now)).then_some(DetectedModel::Other(other))
    }
}
