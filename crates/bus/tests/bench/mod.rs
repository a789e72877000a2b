//! A bus, virtual motors and the time between them: the shared world of the stories.
#![allow(
    dead_code,
    reason = "each story uses the part of the bench that it needs"
)]

use std::time::Duration;

use motorlink_bus::{
    Activity, Bus, Command, Consent, Event, MotorStatus, Output, RawInterval, RawStatus, Refusal,
    Repeat, ScanReport,
};
use motorlink_protocol::{
    AssignableId, CurrentTarget, Drive, Frame, Instant, Mode, MotorId, PositionTarget, Request,
    Setpoint, SpeedTarget,
};
use motorlink_simulator::{World, WorldConfig};

pub const ID: MotorId = MotorId::FIRST;

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

/// A frame that the bus sent, and when.
#[derive(Clone, Copy, Debug)]
pub struct Sent {
    pub at: Instant,
    pub frame: Frame,
}

impl Sent {
    pub fn request(&self) -> Request {
        Request::parse(&self.frame).unwrap()
    }

    pub fn drive_of(&self, motor: MotorId) -> Option<Drive> {
        match self.request() {
            Request::Drive { id, drive } if id == motor => Some(drive),
            _ => None,
        }
    }

    pub fn is_switch(&self) -> bool {
        matches!(self.request(), Request::SwitchMode { .. })
    }

    pub fn is_query(&self) -> bool {
        matches!(self.request(), Request::Query { .. })
    }
}

pub struct Bench {
    pub now: Instant,
    pub bus: Bus,
    pub world: World,
    pub sent: Vec<Sent>,
    pub events: Vec<(Instant, Event)>,
    /// Whether the adapter is still at the frame before, and takes none.
    pub adapter_is_busy: bool,
    /// How many of the next frames it does not take.
    pub refusals: u32,
    /// Whether the page answers its pings.
    pub page_lives: bool,
}

impl Bench {
    pub fn new(config: WorldConfig) -> Self {
        let now = Instant::from_millis(1_000);
        let mut world = World::new(config);
        world.advance(now);
        Self {
            now,
            bus: Bus::new(now),
            world,
            sent: Vec::new(),
            events: Vec::new(),
            adapter_is_busy: false,
            refusals: 0,
            page_lives: true,
        }
    }

    /// A bench whose motors have answered.
    pub fn watching(config: WorldConfig, motors: &[MotorId]) -> Self {
        let mut bench = Self::new(config);
        for motor in motors {
            bench.command(Command::Watch(*motor)).unwrap();
        }
        bench.run(ms(300));
        bench.forget_the_past();
        bench
    }

    /// One motor with ID 1 on a faultless wire.
    pub fn one_motor() -> Self {
        Self::watching(WorldConfig::default(), &[ID])
    }

    pub fn command(&mut self, command: Command) -> Result<(), Refusal> {
        let outcome = self.bus.command(self.now, command);
        self.settle();
        outcome
    }

    pub fn drive(&mut self, setpoint: Setpoint) -> Result<(), Refusal> {
        self.command(Command::Drive {
            id: ID,
            setpoint,
            consent: Consent::None,
        })
    }

    /// Switches loops and waits until it is confirmed.
    pub fn switch(&mut self, mode: Mode) {
        self.command(Command::SwitchMode { id: ID, mode }).unwrap();
        self.run(ms(400));
        assert_eq!(self.world.motor(ID).unwrap().mode(), mode);
    }

    pub fn run(&mut self, duration: Duration) {
        let end = self.now + duration;
        loop {
            let wake = self.settle();
            let next = self
                .world
                .next_event()
                .map_or(wake, |event| event.min(wake))
                .min(end);
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

    /// Time passes while nobody calls the bus: the computer sleeps, or its worker is delayed. What the
    /// motors send meanwhile waits.
    pub fn sleep(&mut self, duration: Duration) {
        self.now = self.now + duration;
        self.world.advance(self.now);
    }

    /// Hands over what has waited.
    pub fn deliver(&mut self) {
        while let Some(chunk) = self.world.receive(self.now) {
            self.bus.receive(self.now, &chunk.bytes);
        }
    }

    /// Runs until something holds; panics when it does not hold in time.
    pub fn run_until(&mut self, limit: Duration, mut holds: impl FnMut(&Self) -> bool) -> Duration {
        let began = self.now;
        while !holds(self) {
            assert!(self.now.since(began) < limit, "not within {limit:?}");
            self.run(ms(1));
        }
        self.now.since(began)
    }

    fn settle(&mut self) -> Instant {
        for _ in 0..1_000 {
            match self.bus.poll(self.now) {
                Output::Transmit(_) if self.adapter_is_busy => self.bus.unsent(),
                Output::Transmit(_) if self.refusals > 0 => {
                    self.refusals -= 1;
                    self.bus.unsent();
                }
                Output::Transmit(frame) => {
                    self.world.transmit(self.now, frame.bytes());
                    self.sent.push(Sent {
                        at: self.now,
                        frame,
                    });
                }
                Output::Event(Event::PingPage) => {
                    if self.page_lives {
                        self.bus.page_answered(self.now);
                    }
                }
                Output::Event(event) => self.events.push((self.now, event)),
                Output::Wait(at) => {
                    assert!(at > self.now, "a busy loop");
                    return at;
                }
            }
        }
        panic!("the bus never rests");
    }

    pub fn forget_the_past(&mut self) {
        self.sent.clear();
        self.events.clear();
    }

    pub fn status(&self, motor: MotorId) -> MotorStatus {
        self.bus
            .motors(self.now)
            .find(|status| status.id == motor)
            .unwrap()
    }

    pub fn activity(&self) -> Activity {
        self.status(ID).activity
    }

    pub fn true_rpm(&self) -> f32 {
        self.world.motor(ID).unwrap().speed_rpm()
    }

    pub fn happened(&self, wanted: impl Fn(&Event) -> bool) -> bool {
        self.events.iter().any(|(_, event)| wanted(event))
    }

    /// When each drive frame to this motor was sent.
    pub fn drive_times(&self, motor: MotorId) -> Vec<Instant> {
        self.sent
            .iter()
            .filter(|s| s.drive_of(motor).is_some())
            .map(|s| s.at)
            .collect()
    }
}

/// The longest distance of two moments in a row.
pub fn longest_gap(times: &[Instant]) -> Duration {
    times
        .windows(2)
        .map(|pair| pair[1].since(pair[0]))
        .max()
        .unwrap_or_default()
}

/// So often, so far apart.
pub fn every(count: u32, interval_ms: u16) -> Repeat {
    let interval = RawInterval::new(interval_ms).unwrap();
    Repeat::Times { count, interval }
}

/// A frame that a person wrote, without any consent.
pub fn raw(frame: Frame, repeat: Repeat) -> Command {
    Command::SendRaw {
        frame,
        repeat,
        consent: Consent::None,
    }
}

/// The frame of a setpoint.
pub fn drive_frame(motor: MotorId, setpoint: Setpoint) -> Frame {
    Request::drive(motor, setpoint).frame()
}

/// The last frame that a person wrote.
pub fn status(bench: &Bench) -> RawStatus {
    bench.bus.raw().unwrap()
}

/// Two motors that have answered.
pub fn two() -> Bench {
    Bench::watching(WorldConfig::with_ids([ID, id(2)]), &[ID, id(2)])
}

/// An address that may be given.
pub fn to(address: u8) -> AssignableId {
    AssignableId::new(id(address)).unwrap()
}

/// Whether it is a set-ID frame, well formed or not.
pub fn is_set_id(sent: &Sent) -> bool {
    sent.frame.bytes().starts_with(&[0xAA, 0x55, 0x53])
}

/// A full scan from its command to its end.
pub fn scan_report(bench: &mut Bench) -> ScanReport {
    bench.forget_the_past();
    bench.command(Command::FullScan).unwrap();
    bench.run_until(ms(60_000), |bench| {
        bench.happened(|event| matches!(event, Event::ScanEnded(_)))
    });
    let report = bench.events.iter().find_map(|(_, event)| match event {
        Event::ScanEnded(report) => Some(report.clone()),
        _ => None,
    });
    bench.forget_the_past();
    report.unwrap()
}
