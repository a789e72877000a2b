//! A host on a virtual wire, in virtual time: the stage on which the stories play.
#![allow(dead_code, reason = "every story uses its own part of the stage")]

use std::time::Duration;

use motorlink_protocol::{
    Acceleration, CurrentTarget, Detail, Frame, Instant, Layout, Mode, MotorId, PositionTarget,
    Reply, Request, Setpoint, SpeedTarget,
};
use motorlink_simulator::{VirtualMotor, World, WorldConfig};

pub const ONE: MotorId = MotorId::FIRST;

pub fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

pub fn ms(millis: u64) -> Duration {
    Duration::from_millis(millis)
}

pub fn us(micros: u64) -> Duration {
    Duration::from_micros(micros)
}

pub fn speed(rpm: i32) -> Setpoint {
    speed_at(rpm, 0)
}

pub fn speed_at(rpm: i32, accel: u8) -> Setpoint {
    Setpoint::Velocity {
        speed: SpeedTarget::new(rpm).unwrap(),
        acceleration: Acceleration::new(accel),
    }
}

pub fn current(amps: f32) -> Setpoint {
    Setpoint::Current(CurrentTarget::from_amps(amps))
}

pub fn angle(degrees: f32) -> Setpoint {
    Setpoint::Position(PositionTarget::from_degrees(degrees))
}

/// How far `to` is from `from` on the circle, -180 to 180 degrees.
pub fn turn_between(from: f32, to: f32) -> f32 {
    (to - from + 180.0).rem_euclid(360.0) - 180.0
}

/// A host that exchanges frames with the world, and its clock.
pub struct Bench {
    pub world: World,
    pub now: Instant,
}

impl Bench {
    pub fn new(config: WorldConfig) -> Self {
        let now = Instant::from_millis(1000);
        let mut world = World::new(config);
        world.advance(now);
        Self { world, now }
    }

    pub fn with_one_motor() -> Self {
        Self::new(WorldConfig::default())
    }

    pub fn with_ids(ids: &[u8]) -> Self {
        Self::new(WorldConfig::with_ids(
            ids.iter().map(|address| id(*address)),
        ))
    }

    pub fn motor(&self) -> &VirtualMotor {
        self.world.motor(ONE).expect("motor 1 is on the wire")
    }

    pub fn motor_mut(&mut self) -> &mut VirtualMotor {
        self.world.motor_mut(ONE).expect("motor 1 is on the wire")
    }

    /// Lets time pass. Nothing that reaches the host meanwhile is kept.
    pub fn wait(&mut self, time: Duration) {
        self.now = self.now + time;
        while self.world.receive(self.now).is_some() {}
    }

    /// Sends ten bytes, then returns all that the host hears in the 10 ms after.
    pub fn send(&mut self, frame: Frame) -> Vec<u8> {
        self.wait(Duration::ZERO);
        self.world.transmit(self.now, frame.bytes());
        self.now = self.now + ms(10);
        let mut heard = Vec::new();
        while let Some(chunk) = self.world.receive(self.now) {
            heard.extend(chunk.bytes);
        }
        heard
    }

    /// Sends a request and reads its reply, if one comes and can be read.
    pub fn ask(&mut self, request: Request) -> Option<Reply> {
        let heard: [u8; 10] = self.send(request.frame()).try_into().ok()?;
        Reply::decode(&Frame::new(heard), request.answered_in()).ok()
    }

    pub fn drive(&mut self, setpoint: Setpoint) -> Option<Reply> {
        self.ask(Request::drive(ONE, setpoint))
    }

    pub fn query(&mut self) -> Reply {
        self.ask(Request::Query { id: ONE }).expect("an answer")
    }

    /// Drives at 50 Hz for so long; `watch` sees the motor every millisecond.
    pub fn drive_watching(
        &mut self,
        setpoint: Setpoint,
        time: Duration,
        mut watch: impl FnMut(Duration, &VirtualMotor),
    ) {
        let start = self.now;
        let frame = Request::drive(ONE, setpoint).frame();
        for millis in 0..u64::try_from(time.as_millis()).unwrap() {
            if millis % 20 == 0 {
                self.world.transmit(self.now, frame.bytes());
            }
            self.now = start + ms(millis + 1);
            while self.world.receive(self.now).is_some() {}
            watch(self.now.since(start), self.motor());
        }
    }

    pub fn drive_for(&mut self, setpoint: Setpoint, time: Duration) {
        self.drive_watching(setpoint, time, |_, _| {});
    }

    /// Drives at 50 Hz until `done`; gives the time since the first frame was sent.
    pub fn drive_until(
        &mut self,
        setpoint: Setpoint,
        limit: Duration,
        done: impl Fn(&VirtualMotor) -> bool,
    ) -> Option<Duration> {
        let mut reached = None;
        self.drive_watching(setpoint, limit, |time, motor| {
            if reached.is_none() && done(motor) {
                reached = Some(time);
            }
        });
        reached
    }

    /// Switches the mode as hosts do: five frames, 20 ms apart.
    pub fn switch(&mut self, mode: Mode) {
        for _ in 0..5 {
            self.world.transmit(
                self.now,
                Request::SwitchMode { id: ONE, mode }.frame().bytes(),
            );
            self.wait(ms(20));
        }
    }
}

/// The fine angle of a drive reply.
pub fn fine_degrees(reply: &Reply) -> f32 {
    match reply.detail {
        Detail::Drive { position } => position.degrees(),
        other => panic!("not in the drive layout: {other:?}"),
    }
}

/// Temperature and coarse angle of a query reply.
pub fn query_detail(reply: &Reply) -> (u8, f32) {
    match reply.detail {
        Detail::Query {
            temperature,
            position,
        } => (temperature.degrees(), position.degrees()),
        other => panic!("not in the query layout: {other:?}"),
    }
}

pub const LAYOUTS: [Layout; 2] = [Layout::Drive, Layout::Query];
