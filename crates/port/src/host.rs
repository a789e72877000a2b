//! The bus on an open line.

use motorlink_bus::{Bus, Event};
use motorlink_messages::LeftBehind;
use motorlink_protocol::Instant;

use crate::line::Line;

/// An open line with its bus.
#[derive(Debug)]
pub struct Host<L> {
    /// The bus.
    pub bus: Bus,
    /// The line.
    pub line: L,
}

/// What follows from a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turned {
    /// The next turn is due at this moment, or earlier when bytes or a command arrive.
    Wait(Instant),
    /// The port is gone.
    Gone,
}

/// What a bus leaves when it ends.
#[derive(Clone, Debug)]
pub struct BusEnd {
    /// Its last events: a scan that ends with its port is cancelled.
    pub last: Vec<Event>,
    /// The motors that it has driven, and that may turn.
    pub left: LeftBehind,
}

impl<L: Line> Host<L> {
    /// Bytes have arrived.
    pub fn receive(&mut self, now: Instant, bytes: &[u8]) {
        self.line.has_received();
        self.bus.receive(now, bytes);
    }

    /// Ends the bus: its port is closed or gone.
    pub fn close(&mut self, now: Instant) -> BusEnd {
        BusEnd {
            last: self.bus.close(now).collect(),
            left: LeftBehind {
                model: self.bus.model(),
                motors: self.bus.left_driven().collect(),
            },
        }
    }
}
