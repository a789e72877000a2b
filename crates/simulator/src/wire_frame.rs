//! Every frame that was on the wire, for logs and tests.

use std::collections::VecDeque;

use motorlink_protocol::{Frame, Instant, MotorId};

/// Frames kept for a reader: 16 s of the busiest exchange (two frames every 2.3 ms).
const KEPT_MAX: usize = 16_384;

/// The sender of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sender {
    /// The host.
    Host,
    /// The motor that had this address at that time.
    Motor(MotorId),
}

/// A frame as sent, before collisions and faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WireFrame {
    /// Start of its first byte on the wire.
    pub at: Instant,
    /// The sender.
    pub from: Sender,
    /// The bytes.
    pub frame: Frame,
}

/// Frames that were not drained yet; the oldest are dropped first.
#[derive(Clone, Debug, Default)]
pub(crate) struct WireFrameLog {
    kept: VecDeque<WireFrame>,
}

impl WireFrameLog {
    pub(crate) fn push(&mut self, wire_frames: WireFrame) {
        if self.kept.len() >= KEPT_MAX {
            self.kept.pop_front();
        }
        self.kept.push_back(wire_frames);
    }

    pub(crate) fn drain(&mut self) -> impl Iterator<Item = WireFrame> + '_ {
        self.kept.drain(..)
    }
}
