//! Every frame that was on the wire, for logs and tests.

use std::collections::VecDeque;

use motorlink_protocol::{Frame, Instant, MotorId};

/// Frames kept for a reader: 16 s of the busiest exchange (two frames every 2.3 ms).
const KEPT_MAX: usize = 16_384;

/// Who put a frame on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Speaker {
    /// The host.
    Host,
    /// The motor that had this address then.
    Motor(MotorId),
}

/// A frame as its speaker sent it, before collisions and faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Traffic {
    /// Start of its first byte on the wire.
    pub at: Instant,
    /// Who sent it.
    pub from: Speaker,
    /// What was sent.
    pub frame: Frame,
}

/// The frames that nobody has drained yet; the oldest go first when there are too many.
#[derive(Clone, Debug, Default)]
pub(crate) struct TrafficLog {
    kept: VecDeque<Traffic>,
    lost: u64,
}

impl TrafficLog {
    pub(crate) fn push(&mut self, traffic: Traffic) {
        if self.kept.len() >= KEPT_MAX {
            self.kept.pop_front();
            self.lost += 1;
        }
        self.kept.push_back(traffic);
    }

    pub(crate) fn drain(&mut self) -> impl Iterator<Item = Traffic> + '_ {
        self.kept.drain(..)
    }

    pub(crate) const fn lost(&self) -> u64 {
        self.lost
    }
}
