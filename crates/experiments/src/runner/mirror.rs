//! The signs of motors that are mounted mirrored: a run has those of the operator, the wire the opposite ones.

use motorlink_protocol::Current;

use super::Telemetry;

impl Telemetry {
    /// The reply with the angle that counts the other way, as speed and current do.
    pub(super) fn with_turned_angle(self) -> Self {
        Self {
            degrees: self.degrees.map(|degrees| (360.0 - degrees) % 360.0),
            ..self
        }
    }

    /// The reply with the opposite sign of speed and current.
    pub(super) fn reversed(self) -> Self {
        Self {
            rpm: self.rpm.map(i16::saturating_neg),
            current: self
                .current
                .map(|current| Current::from_raw(current.raw().saturating_neg())),
            ..self
        }
    }
}
