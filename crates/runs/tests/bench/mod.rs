//! The bench of runs: the bus, virtual motors and both sides of a run, in virtual time, as the port worker joins them.
#![allow(dead_code, reason = "each test file uses its own part of the bench")]

use std::time::Duration;

use motorlink_bus::{Activity, Bus, BusSettings, Command, Event, Output};
use motorlink_experiments::{
    plan::Fleet,
    runner::{Cause, End, Options, Phase, Record, RecordPart},
};
use motorlink_messages::{
    encode,
    runs::{FromRun, ToRun},
};
use motorlink_protocol::{Frame, Instant, Mode, MotorId, family::Model};
use motorlink_runs::{Failed, Host, Input, Program};
use motorlink_simulator::{World, WorldConfig};

pub const ONE: MotorId = MotorId::FIRST;

pub fn id(number: u8) -> MotorId {
    MotorId::new(number).unwrap()
}

pub const fn ms(millis: u64) -> Duration {
    Duration::from_millis(millis)
}

pub struct Bench {
    pub now: Instant,
    pub world: World,
    pub bus: Option<Bus>,
    pub host: Host,
    pub program: Program,
    pub settings: BusSettings,
    pub page_answers: bool,
    /// Whether the next call of the program traps.
    pub traps: bool,
    pub died: bool,
    /// How late the timers of the worker are: the next of these, again and again.
    pub late: Vec<Duration>,
    pub messages: Vec<FromRun>,
    pub wire: Vec<(Instant, Frame)>,
    pub stops_began: usize,
    turns: usize,
    motors: Vec<MotorId>,
}

impl Bench {
    /// A port with these motors, which have replied.
    pub fn new(model: Model, motors: u8) -> Self {
        let motors: Vec<MotorId> = (1..=motors).map(id).collect();
        Self::of(WorldConfig::of(model, motors))
    }

    /// A port with the motors of this world, which have replied.
    pub fn of(config: WorldConfig) -> Self {
        let now = Instant::from_millis(1_000);
        let model = config.motors[0].model;
        let motors: Vec<MotorId> = config.motors.iter().map(|motor| motor.id).collect();
        let mut world = World::new(config);
        world.advance(now);
        let mut bus = Bus::with_model(now, model);
        for id in &motors {
            bus.command(now, Command::Watch(*id)).unwrap();
        }
        let mut bench = Self {
            now,
            world,
            bus: Some(bus),
            host: Host::default(),
            program: Program::default(),
            settings: BusSettings::default(),
            page_answers: true,
            traps: false,
            died: false,
            late: vec![Duration::ZERO],
            messages: Vec::new(),
            wire: Vec::new(),
            stops_began: 0,
            turns: 0,
            motors,
        };
        // A bus enables motors of some models first.
        bench.run(ms(2_500));
        bench
    }

    /// A bench with an armed run.
    pub fn armed(model: Model, motors: u8, steps: &str, options: Options) -> Self {
        let mut bench = Self::new(model, motors);
        bench.arm(steps, options);
        let phase = bench.phase();
        assert!(
            matches!(phase, Some(Phase::Armed { .. })),
            "{:?}",
            bench.messages
        );
        bench
    }

    pub fn arm(&mut self, steps: &str, options: Options) {
        self.arm_sequence(
            format!(r#"{{ "motorlink_sequence": 1, "steps": [{steps}] }}"#),
            options,
        );
    }

    pub fn arm_sequence(&mut self, sequence: String, options: Options) {
        let fleet = Fleet::of(self.motors.iter().copied());
        self.message(&ToRun::Arm {
            run: 7,
            sequence,
            fleet,
            options,
        });
    }

    pub fn start(&mut self) {
        // An idle motor is queried ten times a second.
        self.run(ms(300));
        self.message(&ToRun::Start { run: 7 });
        assert_eq!(self.phase(), Some(Phase::Running), "{:?}", self.messages);
    }

    pub fn message(&mut self, message: &ToRun) {
        self.message_of_age(message, false);
    }

    pub fn message_of_age(&mut self, message: &ToRun, is_old: bool) {
        let bytes = encode(message).unwrap();
        let line = Host::line_state(self.now, self.bus.as_ref());
        self.pass(Input::Message {
            bytes,
            is_old,
            line,
        });
        self.turn();
    }

    /// A command of a person.
    pub fn command(&mut self, mut command: Command) {
        if let Command::Configure(settings) = command {
            self.settings = settings;
            command = Command::Configure(self.host.settings(settings));
        }
        let ends_run = self.host.ended_by(command);
        if let Some(Input::Driven(_)) = ends_run {
            self.host.stop(self.now, self.bus.as_mut(), self.settings);
        }
        if let Some(bus) = &mut self.bus {
            // A refusal is the answer to the person.
            let _ = bus.command(self.now, command);
        }
        if let Some(input) = ends_run {
            self.pass(input);
        }
        self.turn();
    }

    pub fn unplug(&mut self) {
        self.bus = None;
        if self.host.wake().is_some() {
            self.pass(Input::Unplugged);
        }
    }

    fn pass(&mut self, input: Input) {
        if self.died {
            return;
        }
        let Self {
            program,
            traps,
            bus,
            host,
            ..
        } = self;
        let call = |now, input: &Input| (!*traps).then(|| program.handle(now, input));
        let passed = host.pass(self.now, input, bus.as_mut(), self.settings, call);
        self.died |= passed == Err(Failed);
        self.messages.extend(self.program.take_messages());
    }

    /// As `PortOwner::turn` of the worker. Returns when the next turn is due.
    pub fn turn(&mut self) -> Option<Instant> {
        if self.bus.is_some() && self.host.tick_due(self.now).is_some() {
            self.pass(Input::Tick);
        }
        loop {
            while let Some(chunk) = self.world.receive(self.now) {
                if let Some(bus) = &mut self.bus {
                    bus.receive(self.now, &chunk.bytes);
                }
            }
            let bus = self.bus.as_mut()?;
            match bus.poll(self.now) {
                Output::Transmit(frame) => {
                    self.wire.push((self.now, frame));
                    self.world.transmit(self.now, frame.bytes());
                }
                Output::Event(Event::PingPage) if self.page_answers => bus.page_answered(self.now),
                Output::Event(event) => {
                    self.stops_began += usize::from(matches!(event, Event::StopBegan(_)));
                    if let Some(input) = self.host.input_of(&event, bus.model()) {
                        self.pass(input);
                    }
                }
                Output::Wait(at) => {
                    let others = [self.world.next_event(), self.host.wake()];
                    return others.into_iter().flatten().chain([at]).min();
                }
            }
        }
    }

    /// Lets time pass.
    pub fn run(&mut self, time: Duration) {
        let until = self.now + time;
        while self.now < until {
            let wake = self.turn().unwrap_or(until);
            let late = self.late[self.turns % self.late.len()];
            self.turns += 1;
            self.now = (wake.max(self.now) + late).min(until);
            self.world.advance(self.now);
        }
        self.turn();
    }

    /// The worker does not run for this time.
    pub fn sleep(&mut self, time: Duration) {
        self.now = self.now + time;
        self.world.advance(self.now);
        self.turn();
    }

    pub fn switch_to(&mut self, mode: Mode) {
        for id in self.motors.clone() {
            self.command(Command::SwitchMode { id, mode });
        }
        self.run(ms(400));
    }

    /// The phase of the last state that the page was told.
    pub fn phase(&self) -> Option<Phase> {
        let mut messages = self.messages.iter().rev();
        messages.find_map(|message| match message {
            FromRun::State(state) => Some(state.phase),
            _ => None,
        })
    }

    pub fn cause(&self) -> Option<Cause> {
        match self.phase() {
            Some(Phase::Ended(End::Aborted { cause, .. })) => Some(cause),
            _ => None,
        }
    }

    /// The record, as the page puts it together: it begins at the first state with a start.
    pub fn record(&self) -> RecordPart {
        let mut record = RecordPart::default();
        let has_begun =
            |message: &&FromRun| matches!(message, FromRun::State(state) if state.began.is_some());
        let of_run = self.messages.iter().skip_while(|it| !has_begun(it));
        for message in of_run {
            if let FromRun::Part { part, .. } = message {
                record.samples.extend(part.samples.iter().copied());
                record.sent.extend(part.sent.iter().copied());
                record.marks.extend(part.marks.iter().copied());
            }
        }
        record
    }

    /// The record, as the page puts it together.
    pub fn whole_record(&self) -> Record {
        let mut record = Record::default();
        for message in &self.messages {
            if let FromRun::State(state) = message {
                if let Some(began) = state.began {
                    record.began(began);
                }
                if let Phase::Ended(end) = state.phase {
                    record.ended(end);
                }
            }
        }
        record.add_part(self.record());
        record
    }

    /// The first motor that is driven, if there is one.
    pub fn driven(&self) -> Option<MotorId> {
        let bus = self.bus.as_ref()?;
        let mut motors = bus.motors(self.now);
        let driven = motors.find(|motor| {
            matches!(
                motor.activity,
                Activity::Driven { .. } | Activity::DrivenRaw
            )
        });
        driven.map(|motor| motor.id)
    }

    pub fn fastest_rpm(&self) -> f64 {
        let speeds = self
            .world
            .motors()
            .map(|motor| f64::from(motor.speed_rpm()).abs());
        speeds.fold(0.0, f64::max)
    }
}
