//! For tests: a bus on a virtual line, and the record of it.

use std::time::Duration;

use motorlink_bus::{Bus, Command, Consent, Event, Output};
use motorlink_protocol::{Instant, MotorId, Setpoint, SpeedTarget};
use motorlink_simulator::{LineCondition, World, WorldConfig};

use crate::{
    doctor::Verdict,
    record::{Line, Record},
};

pub const ID: MotorId = MotorId::FIRST;

/// A bus on a virtual line, examined ten times a second as on the page.
pub struct RecordedBus {
    pub now: Instant,
    pub bus: Bus,
    pub world: World,
    pub record: Record,
    /// The late calls and replies a second that the record is told instead of those of the bus.
    pub late_hz: Option<u16>,
}

impl RecordedBus {
    /// The line is good at first, as on the page.
    pub fn new(case: LineCondition) -> Self {
        let mut bus = Self::on(World::new(WorldConfig::default()));
        bus.run_to(bus.now + Duration::from_secs(1));
        bus.world.set_line_condition(bus.now, case);
        bus
    }

    pub fn on(world: World) -> Self {
        let now = Instant::from_millis(1_000);
        let mut bus = Bus::new(now);
        for command in [Command::IdQuery, Command::Watch(ID)] {
            bus.command(now, command).unwrap();
        }
        Self {
            now,
            bus,
            world,
            record: Record::default(),
            late_hz: None,
        }
    }

    pub fn drive(&mut self, rpm: i32) {
        let command = Command::Drive {
            id: ID,
            setpoint: Setpoint::velocity(SpeedTarget::new(rpm).unwrap()),
            consent: Consent::None,
        };
        self.bus.command(self.now, command).unwrap();
    }

    pub fn look(&mut self) {
        let motors: Vec<_> = self.bus.motors(self.now).collect();
        let mut status = self.bus.line_status(self.now);
        status.late_hz = self.late_hz.unwrap_or(status.late_hz);
        self.record.look(Some(Line {
            now: self.now,
            status: &status,
            motors: &motors,
        }));
    }

    pub fn run(&mut self, seconds: u64) -> &Verdict {
        for _ in 0..seconds * 10 {
            self.run_to(self.now + Duration::from_millis(100));
            self.look();
        }
        self.record.verdict()
    }

    pub fn run_to(&mut self, end: Instant) {
        loop {
            while let Some(chunk) = self.world.receive(self.now) {
                self.bus.receive(self.now, &chunk.bytes);
            }
            let wake = match self.bus.poll(self.now) {
                Output::Transmit(frame) => {
                    self.world.transmit(self.now, frame.bytes());
                    continue;
                }
                Output::Event(Event::PingPage) => {
                    self.bus.page_answered(self.now);
                    continue;
                }
                Output::Event(_) => continue,
                Output::Wait(at) => at,
            };
            if self.now >= end {
                return;
            }
            let next = self.world.next_event().map_or(wake, |at| at.min(wake));
            self.now = next.clamp(self.now, end);
        }
    }
}
