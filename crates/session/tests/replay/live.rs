//! A live line: a bus, virtual motors and virtual time, written as a session.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::{
    Bus, Command, Consent, Event, LineStatus, MotorStatus, Output, Refusal, Sample,
};
use motorlink_messages::{
    Adapter, Connection, ToPage, Update, encode,
    recorder::ToRecorder,
    sessions::{Kept, KeptRecord},
};
use motorlink_protocol::{
    CurrentTarget, Instant, Mode, MotorId, PositionTarget, Setpoint, SpeedTarget, family::Model,
};
use motorlink_recorder::{LocalTime, Recorder, WallClock};
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
    /// Keeps the frames, and the states that the page gets.
    recorder: Option<Recorder>,
    /// The updates to the page: some have many samples, many have none.
    pub updates: Vec<Update>,
    update_samples: Vec<Sample>,
}

/// A worker posts samples to the page so often.
const UPDATE_EVERY: Duration = Duration::from_millis(50);

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
            recorder: None,
            updates: Vec::new(),
            update_samples: Vec::new(),
        }
    }

    /// A line whose states are recorded too, as the page gets them.
    pub fn with_states(model: Model) -> Self {
        let mut recorder = Recorder::new(WallClock::from_us(ZERO_US, LocalTime::fixed(0)));
        recorder.handle(ToRecorder::Epoch {
            unix_ms: f64::from(u32::try_from(ZERO_US / 1_000_000).unwrap()) * 1_000.0,
        });
        Self {
            recorder: Some(recorder),
            ..Self::new(WorldConfig::of(model, [id(1), id(2)]))
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
            self.post_update();
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

    /// Posts an update if one is due.
    fn post_update(&mut self) {
        let Some(recorder) = &mut self.recorder else {
            return;
        };
        let now = self.now;
        let last = self
            .updates
            .last()
            .map_or(Instant::ZERO, |update| update.now);
        if now.since(last) < UPDATE_EVERY {
            return;
        }
        let update = Update {
            now,
            connection: Connection::Connected(Adapter::Serial(None)),
            halted: self.bus.is_halted(),
            motors: self.bus.motors(now).collect(),
            job: self.bus.job(),
            raw: self.bus.raw(),
            line: Some(self.bus.line_status(now)),
            samples: std::mem::take(&mut self.update_samples),
            notices: Vec::new(),
        };
        recorder.add_state(encode(&ToPage::Update(update.clone())).unwrap());
        self.updates.push(update);
    }

    fn happened(&mut self, event: Event) {
        self.write_notices();
        if let Some(recorder) = &mut self.recorder {
            match event {
                Event::Line(line) => recorder.add_event(&line),
                Event::Telemetry(sample) => self.update_samples.push(sample),
                _ => {}
            }
            return;
        }
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

    /// The session file that is made of what the recorder keeps, and every update to the page.
    pub fn save(self) -> (Vec<u8>, Vec<Update>) {
        let mut recorder = self.recorder.expect("it records");
        let mut part = recorder.first_kept(None, 100);
        let mut writer: Option<Writer> = None;
        loop {
            let Kept::Part {
                zero_us,
                records,
                is_last,
                ..
            } = part
            else {
                panic!("{part:?}")
            };
            let writer = writer.get_or_insert_with(|| Writer::new(zero_us, &[("page", "test")]));
            for record in records {
                match record {
                    KeptRecord::Line(event) => writer.line(&event),
                    KeptRecord::State { at, stored } => writer.state(at, &stored),
                    KeptRecord::Message { .. } => panic!("there are none"),
                }
            }
            if is_last {
                break;
            }
            part = recorder.next_kept(100);
        }
        (writer.unwrap().finish(), self.updates)
    }

    fn complete(&mut self) {
        self.run(ms(50));
        self.write_notices();
        let end = session::Event::new(EventKind::Bookmark, "the end");
        self.writer.event(self.now, &end);
    }
}
