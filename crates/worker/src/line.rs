//! The line: a serial port or the virtual bus.

use motorlink_messages::{Adapter, VirtualLine, VirtualWire};
use motorlink_protocol::{Frame, Instant, MotorId};
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

    /// Returns whether the line accepted the frame.
    #[must_use]
    pub(crate) fn write(&mut self, now: Instant, frame: Frame) -> bool {
        match self {
            Self::Serial(serial) => serial.write(now, frame),
            Self::Virtual(_, world) => {
                world.transmit(now, frame.bytes());
                true
            }
        }
    }

    /// Injects a fault into the virtual line, or removes it. Does nothing to a real one.
    pub(crate) fn set_wire(&mut self, now: Instant, wire: VirtualWire) {
        if let Self::Virtual(_, world) = self {
            world.set_line_condition(now, line_condition(wire));
        }
    }

    /// The next received bytes of the virtual line.
    pub(crate) fn take_received(&mut self, now: Instant) -> Option<Vec<u8>> {
        match self {
            Self::Serial(_) => None,
            Self::Virtual(_, world) => world.receive(now).map(|chunk| chunk.bytes.clone()),
        }
    }

    /// When [`Self::take_received`] may have bytes next.
    pub(crate) fn next_event(&self) -> Option<Instant> {
        match self {
            Self::Serial(_) => None,
            Self::Virtual(_, world) => world.next_event(),
        }
    }
}

const fn line_condition(wire: VirtualWire) -> LineCondition {
    match wire {
        VirtualWire::Good => LineCondition::Good,
        VirtualWire::Dead => LineCondition::Dead,
        VirtualWire::EchoOnly => LineCondition::EchoOnly,
        VirtualWire::SharedId => LineCondition::SharedId,
        VirtualWire::NoiseGrowsWithSpeed => LineCondition::NoiseGrowsWithSpeed,
        VirtualWire::HoldsBytes => LineCondition::HoldsBytes,
        VirtualWire::Stranger => LineCondition::Stranger,
    }
}
