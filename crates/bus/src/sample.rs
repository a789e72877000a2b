//! One reply with its time.

use motorlink_protocol::{Instant, Reply};

/// One reply, when it was complete, and how long its exchange took.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample {
    /// When its last byte was read.
    pub at: Instant,
    /// What it says.
    pub reply: Reply,
}
