//! A live line: a bus, virtual motors and virtual time, written as a session.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::{
    Bus, Command, Consent, Event, LineStatus, MotorStatus, Output, Refusal, Sample,
};
use motorlink_protocol::{
    CurrentTarget, Instant, Mode, MotorId, PositionTarget, Setpoint, SpeedTarget, family::Model,
};
use motorlink_session::{self as session, EventKind, Writer};
use motorlink_simulator::{World, WorldConfig};

/// 2026-11-21 13:15:36.962 UTC at [`Instant::ZERO`].
pub const ZERO_US: i64 = 1_795_266_936_962_000;

/// The page notices an event of the bus at its next frame of the screen.
const NOTICED_AFTER: Duration = Duration::from_millis(17);

pub fn ms(millis: u64) -> Duration {
    Duration::from_millis(millis)
}

pub fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

pub fn rpm(rpm: i32) -> Setpoint {
    Setpoint::velocity(SpeedTarget::new(rpm).unwrap())
}

pub fn amps(amps: f32) -> Setpoint {
    Setpoint::Current(CurrentTarget::from_amps(amps))
}

pub fn degrees(degrees: f32) -> Setpoint {
    Setpoint::Position(PositionTarget::from_degrees(degrees))
}

/// What the page shows at a time.
#[derive(Clone, Debug)]
pub struct Shown {
    pub at: Instant,
    pub motors: Vec<MotorStatus>,
    pub line: LineStatus,
}

pub struct Live {
    pub now: Instant,
    pub bus: Bus,
    pub world: World,
    writer: Writer,
    notices: VecDeque<(Instant, session::Event)>,
    /// How many of the next frames the port refuses.
    pub refusals: u32,
    pub shown: Vec<Shown>,
    samples: Vec<Sample>,
}

impl Live {
    pub fn new(config: WorldConfig) -> Self {
        let now = Instant::from_millis(1_000);
        let model = config
            .motors
            .first()
            .map_or(Model::Ddsm115, |motor| motor.model);
        let mut world = World::new(config);
        world.advance(now);
        Self {
            now,
            bus: Bus::with_model(now, model),
            world,
            writer: Writer::new(ZERO_US, &[("page", "test")]),
            notices: VecDeque::new(),
            refusals: 0,
            shown: Vec::new(),
            samples: Vec::new(),
        }
    }

    /// A line of this model with motors 1 and 2, which have answered.
    pub fn of(model: Model) -> Self {
        let mut live = Self::new(WorldConfig::of(model, [id(1), id(2)]));
        live.watch();
        live
    }

    pub fn watch(&mut self) {
        for address in [1, 2] {
            self.command(Command::Watch(id(address))).unwrap();
        }
        self.run(ms(1_000));
        // Before its first answer, a motor is in no record.
        self.shown.clear();
    }

    pub fn command(&mut self, command: Command) -> Result<(), Refusal> {
        let outcome = self.bus.command(self.now, command);
        self.settle();
        outcome
    }

    pub fn drive(&mut self, address: u8, setpoint: Setpoint) {
        let id = id(address);
        let consent = Consent::None;
        let command = Command::Drive {
            id,
            setpoint,
            consent,
        };
        self.command(command).unwrap();
    }

    pub fn switch(&mut self, address: u8, mode: Mode) {
        let id = id(address);
        self.command(Command::SwitchMode { id, mode }).unwrap();
    }

    /// Runs, and notes what the page shows every few milliseconds.
    pub fn run(&mut self, duration: Duration) {
        let end = self.now + duration;
        while self.now < end {
            let step = (self.now + ms(61)).min(end);
            self.run_to(step);
            if step == end {
                // A command may follow at the same time.
                break;
            }
            self.shown.push(Shown {
                at: self.now,
                motors: self.bus.motors(self.now).collect(),
                line: self.bus.line_status(self.now),
            });
        }
    }

    /// The port is closed for hours, then another bus goes on.
    pub fn pass_hours(&mut self, hours: u64) {
        self.write_notices();
        self.now = self.now + Duration::from_secs(hours * 3_600);
        self.world.advance(self.now);
        while self.world.receive(self.now).is_some() {}
        let model = self.bus.model();
        self.bus = Bus::with_model(self.now, model);
        self.watch();
    }

    fn run_to(&mut self, end: Instant) {
        loop {
            let wake = self.settle();
            let next = self.world.next_event();
            let next = next.map_or(wake, |event| event.min(wake)).min(end);
            self.now = next.max(self.now);
            self.world.advance(self.now);
            while let Some(chunk) = self.world.receive(self.now) {
                self.bus.receive(self.now, &chunk.bytes);
            }
            if self.now >= end {
                self.settle();
                return;
            }
        }
    }

    fn settle(&mut self) -> Instant {
        for _ in 0..1_000 {
            match self.bus.poll(self.now) {
                Output::Transmit(_) if self.refusals > 0 => {
                    self.refusals -= 1;
                    self.bus.transmit_failed();
                }
                Output::Transmit(frame) => self.world.transmit(self.now, frame.bytes()),
                Output::Event(Event::PingPage) => self.bus.page_answered(self.now),
                Output::Event(event) => self.happened(event),
                Output::Wait(at) => {
                    assert!(at > self.now, "a busy loop");
                    return at;
                }
            }
        }
        panic!("the bus never rests");
    }

    fn happened(&mut self, event: Event) {
        self.write_notices();
        let (kind, motors) = match event {
            Event::Line(line) => return self.writer.line(&line),
            Event::Telemetry(sample) => return self.samples.push(sample),
            Event::StopBegan(_) => (EventKind::StopBegan, Vec::new()),
            Event::StopEnded(report) => (EventKind::StopEnded, report.motors),
            _ => (EventKind::Notice, Vec::new()),
        };
        let event = session::Event {
            motors,
            ..session::Event::new(kind, kind.name())
        };
        self.notices.push_back((self.now + NOTICED_AFTER, event));
    }

    fn write_notices(&mut self) {
        while let Some((at, event)) = self.notices.pop_front_if(|(at, _)| *at <= self.now) {
            self.writer.event(at, &event);
        }
    }

    /// The session file, and what the page has shown.
    pub fn end(mut self) -> (Vec<u8>, Vec<Shown>) {
        self.complete();
        (self.writer.finish(), self.shown)
    }

    /// The session file, and every reply.
    pub fn end_with_samples(mut self) -> (Vec<u8>, Vec<Sample>) {
        self.complete();
        (self.writer.finish(), self.samples)
    }

    fn complete(&mut self) {
        self.run(ms(50));
        self.write_notices();
        let end = session::Event::new(EventKind::Bookmark, "the end");
        self.writer.event(self.now, &end);
    }
}
