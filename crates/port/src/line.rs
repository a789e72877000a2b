//! The line: what the bus writes to and reads from.

use motorlink_protocol::{Frame, Instant, family::Model};
use motorlink_simulator::World;

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// The port has taken it.
    Taken,
    /// The port does not take it now, for example because frames before it are not sent yet. It was not sent.
    Refused,
    /// The port is gone.
    Gone,
}

/// An open line.
pub trait Line {
    /// Writes a frame without waiting for the wire.
    fn write(&mut self, now: Instant, model: Model, frame: &Frame) -> Written;

    /// Bytes have arrived: the line carries frames.
    fn has_received(&mut self) {}

    /// The bytes that have arrived by now, of a line that has no reader of its own.
    fn take_received(&mut self, _now: Instant) -> Option<Vec<u8>> {
        None
    }

    /// When [`Line::take_received`] may have bytes next.
    fn next_event(&self) -> Option<Instant> {
        None
    }
}

impl<L: Line + ?Sized> Line for Box<L> {
    fn write(&mut self, now: Instant, model: Model, frame: &Frame) -> Written {
        (**self).write(now, model, frame)
    }

    fn has_received(&mut self) {
        (**self).has_received();
    }

    fn take_received(&mut self, now: Instant) -> Option<Vec<u8>> {
        (**self).take_received(now)
    }

    fn next_event(&self) -> Option<Instant> {
        (**self).next_event()
    }
}

/// Virtual motors in this process.
impl Line for World {
    fn write(&mut self, now: Instant, _model: Model, frame: &Frame) -> Written {
        self.transmit(now, frame.bytes());
        Written::Taken
    }

    fn take_received(&mut self, now: Instant) -> Option<Vec<u8>> {
        self.receive(now).map(|chunk| chunk.bytes.clone())
    }

    fn next_event(&self) -> Option<Instant> {
        Self::next_event(self)
    }
}
