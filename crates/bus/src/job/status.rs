//! What the page shows of a scan or an ID change in progress.

use motorlink_protocol::{AssignableId, MotorId};

/// A full scan or an ID change under way.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SurveyStatus {
    /// What was driven is being stopped first.
    Stopping,
    /// Every address is being asked.
    Scanning {
        /// Addresses that were asked at least once, 0-254.
        asked: u16,
        /// Addresses in all: 254.
        of: u16,
        /// How long it may still take, in milliseconds; a guess from the windows so far.
        left_ms: u32,
        /// Who has answered so far, in the order of IDs.
        found: Vec<MotorId>,
    },
    /// A new ID is being set and verified.
    SettingId {
        /// The present one.
        from: MotorId,
        /// The new one.
        to: AssignableId,
    },
}
