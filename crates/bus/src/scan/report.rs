//! Result of a full scan.

use motorlink_protocol::MotorId;

/// What a scan has shown of a faulty line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ScanFault {
    /// The adapter delivered only full blocks of 32 bytes. Replies come at any time then, and no motor is proved to be
    /// alone.
    Blocks,
    /// No motor answered, and bytes came that a pair makes which nothing holds at a level.
    Floating,
}

/// Result of a full scan.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ScanReport {
    /// The motors that answered, in the order of IDs.
    pub found: Vec<MotorId>,
    /// Addresses with noise at every probe and no reply: two motors share the ID, or the line is
    /// bad.
    pub noisy: Vec<MotorId>,
    /// What is wrong with the line, if the scan has shown that.
    pub fault: Option<ScanFault>,
    /// Addresses that were probed: 254, or fewer if the scan was cancelled.
    pub asked: u16,
    /// Whether every address was probed. A cancelled scan proves nothing.
    pub complete: bool,
    /// Duration in milliseconds.
    pub took_ms: u32,
}
