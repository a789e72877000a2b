//! What the operator sets for all motors at once.

use crate::{limits::Limits, ramp::Ramp, rate::CommandRate};

/// Rate, ramp and limits. They travel together by
/// [`Command::Configure`](crate::Command::Configure), which starts nothing and is never refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BusSettings {
    /// Drive frames a second to each driven motor.
    pub rate: CommandRate,
    /// How fast commanded speeds may grow; `None` is no limit. Lower speeds and stops are sent at
    /// once.
    pub ramp: Option<Ramp>,
    /// A driven motor that exceeds a limit is stopped. One that would exceed a limit is not
    /// started.
    pub limits: Limits,
    /// Whether a stop sends a brake frame every 300 ms only. One project reports that faster ones keep a DDSM315 from
    /// finishing its deceleration; no other source does.
    pub slow_brake_frames: bool,
}
