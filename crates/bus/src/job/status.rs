//! What the page shows of a scan or an ID change in progress.

use motorlink_protocol::{AssignableId, MotorId};

/// Progress of a full scan or an ID change.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum JobStatus {
    /// Driven motors are being stopped first.
    Stopping,
    /// Every address is being probed.
    Scanning {
        /// Addresses that were probed at least once, 0-254.
        asked: u16,
        /// Addresses in all: 254.
        of: u16,
        /// Estimated remaining time in milliseconds, from the windows so far.
        left_ms: u32,
        /// Motors found so far, in the order of IDs.
        found: Vec<MotorId>,
    },
    /// A new ID is being set and verified.
    SettingId {
        /// The present ID.
        from: MotorId,
        /// The new ID.
        to: AssignableId,
    },
}
