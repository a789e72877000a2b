//! The receiver of the host's adapter.

use motorlink_protocol::Instant;

use super::shared_wire::{PassedByte, Source};

/// Bytes without a pause between them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Run {
    /// The host's own bytes, echoed.
    pub(crate) echo: Vec<u8>,
    /// Bytes of motors.
    pub(crate) reply: Vec<u8>,
    /// When the last byte had passed.
    pub(crate) end: Instant,
    /// Whether bytes collided.
    pub(crate) mixed: bool,
}

/// Collects runs. A receiver is busy for the time of a byte after a start bit, so of two
/// overlapping bytes it receives one, as garbage.
#[derive(Clone, Debug, Default)]
pub(crate) struct HostReceiver {
    run: Run,
}

impl HostReceiver {
    /// Takes a byte that the host can receive. `more` is whether another is on the wire already.
    pub(crate) fn receive(&mut self, byte: PassedByte, more: bool) -> Option<Run> {
        self.run.mixed |= byte.collides;
        if byte.start >= self.run.end {
            match byte.source {
                Source::Host => self.run.echo.push(byte.received),
                Source::Motor(_) => self.run.reply.push(byte.received),
            }
            self.run.end = byte.end;
        }
        (!more).then(|| core::mem::take(&mut self.run))
    }
}
