//! Result of a full scan.

use motorlink_protocol::MotorId;

/// Result of a full scan.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ScanReport {
    /// The motors that answered, in the order of IDs.
    pub found: Vec<MotorId>,
    /// Addresses with noise at every probe and no reply: two motors share the ID, or the line is
    /// bad.
    pub noisy: Vec<MotorId>,
    /// Addresses that were probed: 254, or fewer if the scan was cancelled.
    pub asked: u16,
    /// Whether every address was probed. A cancelled scan proves nothing.
    pub complete: bool,
    /// Duration in milliseconds.
    pub took_ms: u32,
}
