//! What the receiver of the host's adapter makes of the wire.

use motorlink_protocol::Instant;

use super::{Passed, Talker};

/// Bytes without a pause between them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Run {
    /// The host's own bytes, echoed.
    pub(crate) echo: Vec<u8>,
    /// Bytes of motors.
    pub(crate) reply: Vec<u8>,
    /// When the last byte had passed.
    pub(crate) end: Instant,
    /// Whether several spoke at once.
    pub(crate) mixed: bool,
}

/// Gathers runs. A receiver is busy for a byte's time once it has seen a start bit, so of two
/// overlapping bytes it hears one, and that one is garbage.
#[derive(Clone, Debug, Default)]
pub(crate) struct HostEar {
    run: Run,
}

impl HostEar {
    /// A byte passed that the host can hear. `more`: another is on the wire already.
    pub(crate) fn hear(&mut self, byte: Passed, more: bool) -> Option<Run> {
        self.run.mixed |= byte.collides;
        if byte.start >= self.run.end {
            match byte.talker {
                Talker::Host => self.run.echo.push(byte.heard),
                Talker::Motor(_) => self.run.reply.push(byte.heard),
            }
            self.run.end = byte.end;
        }
        (!more).then(|| core::mem::take(&mut self.run))
    }
}
