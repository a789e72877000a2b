//! A host on a line of one motor of any model.
#![allow(dead_code, reason = "each test file uses its own part of it")]

use std::time::Duration;

use motorlink_protocol::{
    Frame, Instant, MotorId, Setpoint, SpeedTarget,
    family::{DriveReading, Mode, ModeReading, Model, Odometry, Reading, Request},
};
use motorlink_simulator::{VirtualMotor, World, WorldConfig};

pub const ONE: MotorId = MotorId::FIRST;
pub const SEPARATE: [Model; 2] = [Model::Ddsm210, Model::Ddsm400];

pub fn ms(millis: u64) -> Duration {
    Duration::from_millis(millis)
}

/// A host on a line of one motor.
pub struct Line {
    pub model: Model,
    pub world: World,
    pub now: Instant,
}

impl Line {
    pub fn of(model: Model) -> Self {
        let now = Instant::from_millis(1_000);
        let mut world = World::new(WorldConfig::of(model, [ONE]));
        world.advance(now);
        Self { model, world, now }
    }

    /// A motor that obeys drive frames.
    pub fn ready(model: Model) -> Self {
        let mut line = Self::of(model);
        if model.spec().needs_enable {
            line.ask(Request::Enable { id: ONE, on: true });
            line.switch(Mode::Velocity);
        }
        line
    }

    pub fn motor(&self) -> &VirtualMotor {
        self.world.motor(ONE).unwrap()
    }

    pub fn wait(&mut self, time: Duration) {
        self.now = self.now + time;
        while self.world.receive(self.now).is_some() {}
    }

    pub fn send(&mut self, frame: Frame) -> Vec<u8> {
        self.wait(Duration::ZERO);
        self.world.transmit(self.now, frame.bytes());
        self.now = self.now + ms(15);
        let chunks = std::iter::from_fn(|| self.world.receive(self.now));
        chunks.flat_map(|chunk| chunk.bytes).collect()
    }

    pub fn ask(&mut self, request: Request) -> Option<Reading> {
        let frame = request.frame(self.model).unwrap();
        let heard: [u8; 10] = self.send(frame).try_into().ok()?;
        let asked = request.reply_layout(self.model);
        Reading::decode(self.model, &Frame::new(heard), asked).ok()
    }

    pub fn switch(&mut self, mode: Mode) {
        self.ask(Request::SwitchMode { id: ONE, mode });
    }

    pub fn drive(&mut self, setpoint: Setpoint) -> DriveReading {
        let request = Request::drive(self.model, ONE, setpoint);
        match self.ask(request) {
            Some(Reading::Drive(reading)) => reading,
            other => panic!("{other:?}"),
        }
    }

    pub fn odometry(&mut self) -> Odometry {
        match self.ask(Request::Query { id: ONE }) {
            Some(Reading::Odometry(odometry)) => odometry,
            other => panic!("{other:?}"),
        }
    }

    pub fn mode(&mut self) -> ModeReading {
        match self.ask(Request::ModeQuery { id: ONE }) {
            Some(Reading::Mode(reading)) => reading,
            other => panic!("{other:?}"),
        }
    }

    /// Drives about 50 times a second.
    pub fn drive_for(&mut self, setpoint: Setpoint, time: Duration) {
        let end = self.now + time;
        while self.now < end {
            let request = Request::drive(self.model, ONE, setpoint);
            self.send(request.frame(self.model).unwrap());
            self.wait(ms(5));
        }
    }
}

pub fn rpm(rpm: i32) -> Setpoint {
    Setpoint::velocity(SpeedTarget::new(rpm).unwrap())
}
