//! A live line: a bus, virtual motors and virtual time, written as a session.

use std::time::Duration;

use motorlink_bus::{Bus, Command, Consent, Event, Output, Refusal, Sample};
use motorlink_messages::{
    Adapter, Connection, ToPage, Update, encode,
    recorder::ToRecorder,
    sessions::{Kept, KeptRecord, SaveRange},
};
use motorlink_protocol::{
    CurrentTarget, Instant, Mode, MotorId, PositionTarget, Setpoint, SpeedTarget, family::Model,
};
use motorlink_recorder::{LocalTime, Recorder, WallClock};
use motorlink_session::{self as session, EventKind, Writer};
use motorlink_simulator::{World, WorldConfig};

/// 2026-11-21 13:15:36.962 UTC at [`Instant::ZERO`].
pub const ZERO_US: i64 = 1_795_266_936_962_000;
const ZERO_MS: f64 = 1_795_266_936_962.0;

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

pub struct Live {
    pub now: Instant,
    pub bus: Bus,
    pub world: World,
    /// Keeps the frames, and the states that the page gets.
    recorder: Recorder,
    /// The updates to the page.
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
        let mut recorder = Recorder::new(WallClock::from_us(ZERO_US, LocalTime::fixed(0)));
        recorder.handle(ToRecorder::Epoch { unix_ms: ZERO_MS });
        Self {
            now,
            bus: Bus::with_model(now, model),
            world,
            recorder,
            updates: Vec::new(),
            update_samples: Vec::new(),
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

    pub fn run(&mut self, duration: Duration) {
        self.run_to(self.now + duration);
    }

    /// The port is closed for hours, then another bus goes on.
    pub fn pass_hours(&mut self, hours: u64) {
        self.post_update(Connection::Disconnected);
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
            self.update();
            if self.now >= end {
                self.settle();
                return;
            }
        }
    }

    fn settle(&mut self) -> Instant {
        for _ in 0..1_000 {
            match self.bus.poll(self.now) {
                Output::Transmit(frame) => self.world.transmit(self.now, frame.bytes()),
                Output::Event(Event::PingPage) => self.bus.page_answered(self.now),
                Output::Event(event) => self.happened(&event),
                Output::Wait(at) => {
                    assert!(at > self.now, "a busy loop");
                    return at;
                }
            }
        }
        panic!("the bus never rests");
    }

    /// Posts an update if one is due.
    fn update(&mut self) {
        let last = self.updates.last();
        let is_due = |last: &Update| self.now.since(last.now) >= UPDATE_EVERY;
        if last.is_none_or(is_due) {
            self.post_update(Connection::Connected(Adapter::Serial(None)));
        }
    }

    fn post_update(&mut self, connection: Connection) {
        let now = self.now;
        let is_open = connection != Connection::Disconnected;
        let update = Update {
            now,
            connection,
            halted: self.bus.is_halted(),
            motors: self.bus.motors(now).filter(|_| is_open).collect(),
            job: self.bus.job().filter(|_| is_open),
            raw: self.bus.raw().filter(|_| is_open),
            line: is_open.then(|| self.bus.line_status(now)),
            samples: std::mem::take(&mut self.update_samples),
            notices: Vec::new(),
        };
        let message = encode(&ToPage::Update(update.clone())).unwrap();
        self.recorder.add_state(message);
        self.updates.push(update);
    }

    fn happened(&mut self, event: &Event) {
        match event {
            Event::Line(line) => self.recorder.add_event(line),
            Event::Telemetry(sample) => self.update_samples.push(*sample),
            _ => {}
        }
    }

    /// The session file of what the recorder keeps, and every update to the page.
    pub fn end(self) -> (Vec<u8>, Vec<Update>) {
        self.end_as(&[("page", "test")])
    }

    /// The same with this metadata.
    pub fn end_as(mut self, about: &[(&str, &str)]) -> (Vec<u8>, Vec<Update>) {
        self.run(ms(50));
        self.post_update(Connection::Connected(Adapter::Serial(None)));
        let mut part = self.recorder.first_kept(SaveRange::Line, 100);
        let mut writer = Writer::new(ZERO_US, about);
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
            assert_eq!(zero_us, ZERO_US);
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
            part = self.recorder.next_kept(100);
        }
        let end = session::Event::new(EventKind::Bookmark, "the end");
        writer.event(self.now, &end);
        (writer.finish(), self.updates)
    }

    /// The session file, and every reply that the page got.
    pub fn end_with_samples(self) -> (Vec<u8>, Vec<Sample>) {
        let (file, updates) = self.end();
        let samples = updates.iter().flat_map(|update| &update.samples);
        (file, samples.copied().collect())
    }
}
