//! The scan or ID change in progress, and the proof that a scan leaves.

use motorlink_protocol::{Instant, MotorId};

use crate::{id_change::state::IdChange, scan::state::Scan};

/// What has the line to itself.
#[derive(Clone, Debug)]
pub(crate) enum Survey {
    Scan(Box<Scan>),
    IdChange(IdChange),
}

/// A full scan has found this motor and no other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proof {
    pub(crate) id: MotorId,
    pub(crate) at: Instant,
}
