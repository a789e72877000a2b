//! Result of a full scan.

use motorlink_protocol::MotorId;

/// How a full scan ended.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ScanReport {
    /// Who answered, in the order of IDs.
    pub found: Vec<MotorId>,
    /// Addresses at which every look brought noise and none a reply: two motors that share an ID, or
    /// a bad line.
    pub noisy: Vec<MotorId>,
    /// Addresses that were asked: 254, or fewer where it was cancelled.
    pub asked: u16,
    /// Whether every address was asked. A cancelled scan proves nothing.
    pub complete: bool,
    /// How long it took, in milliseconds.
    pub took_ms: u32,
}
