//! The state of the simulated computer, and what happens to it.

use std::{
    collections::{BTreeMap, VecDeque},
    io,
    time::Duration,
};

use fastrand::Rng;
use motorlink_bus::Event;
use motorlink_driver::{Ending, Entry, Input, OpenFailure, Told};
use motorlink_protocol::{Instant, family::Model};
use motorlink_simulator::{MotorConfig, World, WorldConfig};

use super::{
    port::Port,
    rule::{DriverRule, DriverViolation},
    rules::Rules,
    scenario::{Act, DriverScenario, Process},
};

/// The rules are checked at least so often.
pub(super) const CHECKED_EVERY: Duration = Duration::from_millis(10);
/// How late the program may answer, and the system may tell that a port is gone.
const LATE_MS: u64 = 50;

/// The computer, with the motors that are connected to it.
#[derive(Debug)]
pub(super) struct Machine {
    pub(super) now: Instant,
    pub(super) rng: Rng,
    /// The model of the motors.
    pub(super) motors_are: Model,
    /// The model that the port was last opened for.
    pub(super) opened_for: Model,
    pub(super) world: World,
    pub(super) port: Port,
    pub(super) file: Vec<u8>,
    pub(super) disk_full_until: Instant,
    pub(super) acts: VecDeque<(Duration, Act)>,
    /// The earliest moment of the next act.
    pub(super) act_at: Instant,
    /// What comes to the driver, and when.
    pub(super) inputs: Vec<(Instant, Input)>,
    pub(super) silent_until: Instant,
    pub(super) is_opened: bool,
    pub(super) has_ended: bool,
    pub(super) fails: bool,
    /// The time of a process that is killed: it runs on, and nothing of it has an effect.
    pub(super) killed: Option<Killed>,
    pub(super) rules: Rules,
    pub(super) violation: Option<DriverViolation>,
    /// The names of the acts that were done.
    pub(super) done: Vec<&'static str>,
    /// What the driver told, and when.
    pub(super) told: Vec<String>,
}

#[derive(Debug, Default)]
pub(super) struct Killed {
    pub(super) now: Instant,
    pub(super) calls: u32,
}

impl Machine {
    pub(super) fn new(scenario: &DriverScenario) -> Self {
        let mut rng = Rng::with_seed(!scenario.seed);
        let motor = |id: &_| MotorConfig {
            when_silent: scenario.when_silent,
            angle_deg: rng.f32() * 360.0,
            ..MotorConfig::of(scenario.model, *id)
        };
        let world = World::new(WorldConfig {
            seed: scenario.seed,
            motors: scenario.motors.iter().map(motor).collect(),
            ..WorldConfig::of(scenario.model, [])
        });
        Self {
            now: Instant::ZERO + Duration::from_secs(1),
            rng,
            motors_are: scenario.model,
            opened_for: Model::default(),
            world,
            port: Port::default(),
            file: Vec::new(),
            disk_full_until: Instant::ZERO,
            acts: VecDeque::new(),
            act_at: Instant::ZERO,
            inputs: Vec::new(),
            silent_until: Instant::ZERO,
            is_opened: false,
            has_ended: false,
            fails: false,
            killed: None,
            rules: Rules::default(),
            violation: None,
            done: Vec::new(),
            told: Vec::new(),
        }
    }

    /// How often each rule had something to judge.
    pub(super) const fn judged(&self) -> &BTreeMap<DriverRule, u64> {
        &self.rules.judged
    }

    /// A process starts.
    pub(super) fn starts(&mut self, process: &Process) {
        self.acts = process.acts.iter().copied().collect();
        self.act_at = self.now;
        self.inputs.clear();
        self.silent_until = self.now;
        self.is_opened = false;
        self.has_ended = false;
        self.fails = false;
        self.killed = None;
        let begun = self.rules.starts(self.now, &self.world, &self.file);
        self.judge(begun);
    }

    /// The process has ended.
    pub(super) fn ended(&mut self, ending: &Ending, pause: Duration) {
        self.port.open = None;
        if self.killed.is_none() {
            let ended = self
                .rules
                .ended(self.now, ending, &self.world, self.is_opened);
            self.judge(ended);
        }
        self.rules.is_gone(self.now);
        // The next process has a program of its own.
        self.advance(self.now + pause);
    }

    /// Whether nothing that the driver does has an effect any more.
    pub(super) const fn is_over(&self) -> bool {
        self.killed.is_some()
    }

    /// Whether the driver is to fail in this call.
    pub(super) fn fails_now(&mut self) -> bool {
        let fails = std::mem::take(&mut self.fails);
        if fails {
            self.has_ended = true;
            self.rules.fails(self.now, &self.world);
        }
        fails
    }

    /// Lets time pass.
    pub(super) fn advance(&mut self, to: Instant) {
        while self.now < to {
            self.now = to.min(self.now + CHECKED_EVERY);
            self.world.advance(self.now);
            if self.port.back_at.is_some_and(|at| at <= self.now) {
                self.plug();
            }
            let checked = self.rules.check(
                self.now,
                &self.world,
                self.port.is_well(self.now),
                &self.file,
            );
            self.judge(checked);
        }
    }

    pub(super) fn judge(&mut self, outcome: Result<(), DriverViolation>) {
        if let Err(violation) = outcome {
            self.violation.get_or_insert(violation);
        }
    }

    fn plug(&mut self) {
        self.port.back_at = None;
        if self.rng.bool() {
            self.port.name += 1;
        }
        if self.rng.bool() {
            // The system sets its permissions a moment later.
            self.port.refuses_until = self.now + self.late();
        }
    }

    pub(super) fn late(&mut self) -> Duration {
        Duration::from_millis(self.rng.u64(..LATE_MS))
    }

    pub(super) fn open(
        &mut self,
        path: &str,
        model: Model,
        number: u32,
    ) -> Result<(), OpenFailure> {
        if self.is_over() || self.port.path().as_deref() != Some(path) {
            return Err(OpenFailure::NotFound(path.to_owned()));
        }
        if self.now < self.port.refuses_until {
            return Err(OpenFailure::Denied(path.to_owned()));
        }
        if self.opened_for != model {
            self.opened_for = model;
            self.world.set_baud(self.now, model.spec().baud);
        }
        self.port.open = Some(number);
        Ok(())
    }

    /// The time, as the driver reads it.
    pub(super) fn time_of_driver(&self) -> Instant {
        let killed = self.killed.as_ref();
        killed.map_or(self.now, |killed| killed.now)
    }

    /// The driver tells the program something.
    pub(super) fn told(&mut self, told: Told) {
        if self.is_over() {
            return;
        }
        match told {
            Told::Ping => {
                // A silent program answers what it finds when it is back.
                let at = self.now.max(self.silent_until) + self.late();
                self.inputs.push((at, Input::Alive));
            }
            Told::Entry(_, entry) => {
                if !matches!(entry, Entry::Event(Event::Line(_) | Event::Telemetry(_))) {
                    self.told.push(format!("{:?} {entry:?}", self.now));
                }
                let is_there = self.port.back_at.is_none();
                let told = self.rules.told(self.now, &entry, &self.world, is_there);
                self.judge(told);
            }
        }
    }

    /// The driver has opened the port for this model, or has not.
    pub(super) fn opened(&mut self, model: Option<Model>) {
        if self.is_over() {
            return;
        }
        self.is_opened = model.is_some();
        let fits = model.map(|model| model.is_like(self.motors_are));
        let opened = self.rules.opened(self.now, fits);
        self.judge(opened);
    }

    /// The file that says what is driven.
    pub(super) fn file(&self) -> &[u8] {
        &self.file
    }

    /// The driver writes that file.
    pub(super) fn write(&mut self, content: &[u8]) -> io::Result<()> {
        if self.is_over() {
            return Ok(());
        }
        let is_full = self.now < self.disk_full_until;
        self.rules.writes(!is_full);
        if is_full {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.file = content.to_vec();
        Ok(())
    }
}
