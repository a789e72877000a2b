//! The scan or ID change in progress, and the proof that a scan leaves.

use motorlink_protocol::{Instant, MotorId};

use crate::{id_change::state::IdChange, scan::state::Scan};

/// A job: it has the line to itself.
#[derive(Clone, Debug)]
pub(crate) enum Job {
    Scan(Box<Scan>),
    IdChange(IdChange),
}

/// Proof of a full scan that this motor is the only one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proof {
    pub(crate) id: MotorId,
    pub(crate) at: Instant,
}
