//! The line: a serial port or the virtual bus.

use motorlink_messages::{Adapter, VirtualLine};
use motorlink_port::Written;
use motorlink_protocol::{Frame, Instant, MotorId, family::Model};
use motorlink_simulator::{LineCondition, World, WorldConfig};

use crate::serial::SerialLine;

/// The line that the bus writes to and reads from.
pub(crate) enum Line {
    /// Bytes are delivered by [`crate::serial::read`].
    Serial(SerialLine),
    /// Bytes are fetched at the times that the world gives.
    Virtual(VirtualLine, Box<World>),
}

impl Line {
    /// The built-in line: these motors on a faultless wire, at rest.
    pub(crate) fn of_virtual(line: VirtualLine) -> Self {
        let mut config = WorldConfig::of(line.model, line.ids());
        for (motor, fault) in config.motors.iter_mut().zip(line.faults()) {
            motor.fault = Some(*fault);
        }
        Self::Virtual(line, Box::new(World::new(config)))
    }

    /// Whether a motor is known to have this ID at the start. Of a serial line nothing is known.
    pub(crate) fn is_made_with(&self, id: MotorId) -> bool {
        match self {
            Self::Serial(_) => false,
            Self::Virtual(line, _) => line.ids().any(|other| other == id),
        }
    }

    pub(crate) fn adapter(&self) -> Adapter {
        match self {
            Self::Serial(serial) => Adapter::Serial(serial.usb()),
            Self::Virtual(line, _) => Adapter::Virtual(*line),
        }
    }

    /// Injects a fault into the virtual line, or removes it. Does nothing to a real one.
    pub(crate) fn set_wire(&mut self, now: Instant, wire: LineCondition) {
        if let Self::Virtual(_, world) = self {
            world.set_line_condition(now, wire);
        }
    }
}

impl motorlink_port::Line for Line {
    fn write(&mut self, now: Instant, model: Model, frame: &Frame) -> Written {
        match self {
            Self::Serial(serial) => serial.write(now, model, frame),
            Self::Virtual(_, world) => world.write(now, model, frame),
        }
    }

    fn has_received(&mut self) {
        if let Self::Serial(serial) = self {
            serial.has_received();
        }
    }

    fn take_received(&mut self, now: Instant) -> Option<Vec<u8>> {
        match self {
            Self::Serial(_) => None,
            Self::Virtual(_, world) => world.take_received(now),
        }
    }

    fn next_event(&self) -> Option<Instant> {
        match self {
            Self::Serial(_) => None,
            Self::Virtual(_, world) => world.next_event(),
        }
    }
}
