//! Plays a scenario over virtual time and checks the rules after every step.

use std::{
    collections::{BTreeMap, VecDeque},
    ops::AddAssign,
    time::Duration,
};

use motorlink_bus::{
    Activity, Bus, BusSettings, Command, Event, LeftDriven, MotorStatus, Output, StopReason,
};
use motorlink_protocol::{
    Frame, Instant, Mode, MotorId,
    family::{Model, Request},
};
use motorlink_simulator::{MotorConfig, Sender, WireFaults, World, WorldConfig};

use crate::{
    action::{Action, Fault, LineFault, PendingInput},
    rule::{Rule, Violation},
    rules::Rules,
    scenario::Scenario,
    sequence_run::{Answers, Runs, SequenceRun},
};

/// Most steps of the bus at one moment: far above the usual number, and far below a busy loop.
const STEPS_AT_ONCE_MAX: u32 = 2_000;
/// Shortest time between unplug and replug: a hand and the system need it. The adapter's buffer is
/// lost then.
const PULLED_OUT_FOR: Duration = Duration::from_millis(300);
/// Most wake-ups per second: four per exchange at the highest rate of the line.
const WAKES_A_SECOND_MAX: u32 = 2_400;
/// After the last action everything is stopped, and stands within this time.
const LAST_STOP: Duration = Duration::from_secs(8);
/// After Release only queries are sent for this long.
const REST: Duration = Duration::from_secs(1);
/// Below this speed a wheel stands.
const STANDS_RPM: f32 = 1.0;
/// After a call this late every setpoint is withdrawn.
const LATE_MAX: Duration = Duration::from_millis(500);
/// Mode switch frames for a motor that needs many.
const MANY_SWITCHES: u8 = 5;
/// The speed that a motor was seen to report for ever: `waveshareteam/ddsm_example#2`.
const STUCK_RPM: f32 = -0.1;

/// Coverage of the played scenarios.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// How often each fault happened.
    pub faults: BTreeMap<Fault, u64>,
    /// How often each rule was applied.
    pub judged: BTreeMap<Rule, u64>,
    /// How the runs of sequences ended.
    pub runs: Runs,
}

impl AddAssign for Coverage {
    fn add_assign(&mut self, other: Self) {
        self.runs += other.runs;
        for (fault, times) in other.faults {
            *self.faults.entry(fault).or_default() += times;
        }
        for (rule, times) in other.judged {
            *self.judged.entry(rule).or_default() += times;
        }
    }
}

/// Where a scenario broke a rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Number of the last action before it, from 0.
    pub step: usize,
    /// The broken rule.
    pub violation: Violation,
}

/// Plays a scenario to its end, or to the first broken rule.
///
/// # Errors
///
/// The broken rule, and the action at which it broke.
pub fn play(scenario: &Scenario, coverage: &mut Coverage) -> Result<(), Failure> {
    let mut player = Player::new(scenario);
    let mut count = |fault, times: usize| {
        if let Ok(times @ 1..) = u64::try_from(times) {
            *coverage.faults.entry(fault).or_default() += times;
        }
    };
    count(Fault::NeedsFiveSwitches, scenario.need_five_switches.len());
    count(Fault::SpeedStuck, scenario.speed_stuck.len());
    count(Fault::ObeysAll, usize::from(scenario.obey_all));
    count(Fault::of_firmware(scenario.when_silent), 1);
    for (step, action) in scenario.actions.iter().enumerate() {
        if let Some(fault) = action.fault() {
            *coverage.faults.entry(fault).or_default() += 1;
        }
        let outcome = player.apply(action);
        outcome.map_err(|violation| Failure { step, violation })?;
    }
    let ended = player.end();
    coverage.runs += player.runs;
    player.rules.judge(Rule::ComesToRest);
    for (rule, times) in &player.rules.judged {
        *coverage.judged.entry(*rule).or_default() += times;
    }
    let step = scenario.actions.len();
    ended.map_err(|violation| Failure { step, violation })
}

/// The last `lines` of the trace of a scenario, up to its end or the first broken rule.
#[must_use]
pub fn trace_lines(scenario: &Scenario, lines: usize) -> Vec<String> {
    let mut player = Player::new(scenario);
    player.passed = Some(VecDeque::with_capacity(lines));
    for action in &scenario.actions {
        player.note(|| format!("{action:?}"));
        if player.apply(action).is_err() {
            return player.passed.into_iter().flatten().collect();
        }
    }
    // `play` reports a broken rule.
    let _ = player.end();
    player.passed.into_iter().flatten().collect()
}

struct Player {
    now: Instant,
    world: World,
    /// `None` while the adapter is unplugged.
    bus: Option<Bus>,
    model: Model,
    /// Whether Stop all motors is in force. It outlives the port.
    halted: bool,
    line: LineFault,
    /// What is remembered if the bus is lost now: what was left driven before the last frame.
    left_driven: Vec<LeftDriven>,
    page_answers: bool,
    /// Commands that were clicked while the page hung, with their times.
    clicked: Vec<(Instant, Command)>,
    settings: BusSettings,
    rules: Rules,
    motors: Vec<MotorId>,
    /// Frames other than queries since the last check.
    acted: u64,
    /// Start of the current second, and the number of wake-ups in it.
    wakes: (Instant, u32),
    /// Latest time of the next call, as the bus asked.
    promised: Option<Instant>,
    /// Frames that the port will refuse.
    refuses: u8,
    /// The next frames to truncate: number of frames, bytes sent of each, and whether the port
    /// reports it.
    cuts: Option<(u8, usize, bool)>,
    /// The trace, if it is recorded; at most its initial capacity.
    passed: Option<VecDeque<String>>,
    /// The last sequence that was run.
    sequence: Option<SequenceRun>,
    runs: Runs,
}

impl Player {
    fn new(scenario: &Scenario) -> Self {
        let now = Instant::from_millis(1_000);
        let mut world = World::new(WorldConfig {
            seed: scenario.seed,
            motors: scenario
                .motors
                .iter()
                .map(|id| motor(scenario, *id))
                .collect(),
            ..WorldConfig::of(scenario.model, [])
        });
        world.advance(now);
        let mut player = Self {
            now,
            world,
            bus: None,
            model: scenario.model,
            halted: false,
            line: LineFault::None,
            left_driven: Vec::new(),
            page_answers: true,
            clicked: Vec::new(),
            settings: BusSettings::default(),
            rules: Rules::of(scenario.model, &scenario.speed_stuck),
            motors: scenario.motors.clone(),
            acted: 0,
            wakes: (now, 0),
            promised: None,
            refuses: 0,
            cuts: None,
            passed: None,
            sequence: None,
            runs: Runs::default(),
        };
        player.rules.line(now, true);
        player.plug();
        player
    }

    /// A new bus, as the worker creates one for an open port.
    fn plug(&mut self) {
        let bus = Bus::with_model(self.now, self.model).after_another(self.now);
        let mut bus = if self.halted { bus.into_halted() } else { bus };
        let configure = Command::Configure(self.settings);
        let watched = self.motors.iter().copied().map(Command::Watch);
        self.rules.limits(self.settings.limits);
        self.promised = None;
        for command in watched.chain([configure]) {
            // A bus that drives nothing does not refuse this.
            let _: Result<(), _> = bus.command(self.now, command);
        }
        bus.stop_first(self.now, self.left_driven.iter().copied());
        self.bus = Some(bus);
        self.rules.port_opened(self.now, &self.world);
    }

    /// The bus is gone at any moment and without a stop. What was remembered stays.
    fn lose_bus(&mut self, back_after: Duration) -> Result<(), Violation> {
        self.sequence = None;
        if let Some(bus) = self.bus.take() {
            self.halted = bus.is_halted();
            self.rules.port_lost(self.now, &self.world);
        }
        self.run(back_after)
    }

    fn new_page(&mut self) {
        self.clicked.clear();
        self.page_answers = true;
        self.rules.page(self.now, true);
        self.halted = false;
        self.plug();
    }

    fn apply(&mut self, action: &Action) -> Result<(), Violation> {
        match action {
            Action::Command(command) if self.page_answers => self.command(self.now, *command)?,
            // It is delivered when the page resumes.
            Action::Command(command) => self.clicked.push((self.now, *command)),
            Action::Pause(duration) => self.run(*duration)?,
            Action::Line(line) => self.set_line(*line),
            Action::Power { id, on } => {
                if let Some(motor) = self.world.motor_mut(*id) {
                    motor.power(*on);
                }
            }
            Action::Load { id, tenths_nm } => {
                self.rules.loaded(*id);
                if let Some(motor) = self.world.motor_mut(*id) {
                    motor.set_load_nm(f32::from(*tenths_nm) / 10.0);
                }
            }
            Action::Heat { id, celsius } => {
                self.rules.heated(self.now);
                if let Some(motor) = self.world.motor_mut(*id) {
                    motor.set_temperature_c((*celsius).into());
                }
            }
            Action::PageHangs(true) => {
                self.page_answers = false;
                self.rules.page(self.now, false);
            }
            Action::PageHangs(false) => self.page_goes_on()?,
            Action::PageClosed => self.command(self.now, Command::StopAll(StopReason::PageGone))?,
            Action::Unplug => {
                if let Some(mut bus) = self.bus.take() {
                    if let Some(run) = &mut self.sequence {
                        run.unplugged(self.now, self.settings);
                    }
                    self.halted = bus.is_halted();
                    self.left_driven = bus.left_driven().collect();
                    for event in bus.close(self.now) {
                        self.rules.on_event(self.now, &event, &self.world)?;
                    }
                    self.rules.port_lost(self.now, &self.world);
                    self.run(PULLED_OUT_FOR)?;
                }
            }
            Action::Replug => {
                if self.bus.is_none() {
                    self.plug();
                }
            }
            Action::PageCrashes { back_after } => {
                self.lose_bus(*back_after)?;
                self.new_page();
            }
            Action::WorkerDies { back_after } => {
                self.lose_bus(*back_after)?;
                self.plug();
            }
            Action::AnotherComputer { back_after } => {
                self.lose_bus(*back_after)?;
                self.left_driven.clear();
                self.new_page();
                self.rules.knows_nothing(self.now);
            }
            Action::LineDies { lasts } => {
                self.world.set_faults(WireFaults {
                    lose_request: 1.0,
                    ..self.line.faults()
                });
                self.rules.line(self.now, false);
                self.run(*lasts)?;
                self.set_line(self.line);
                if let Some(bus) = &self.bus {
                    self.rules.line_back(self.now, bus, &self.world);
                }
            }
            Action::WorkerAbsent {
                duration, pending, ..
            } => self.away(*duration, pending)?,
            Action::PortRefuses { frames } => self.refuses = *frames,
            Action::PortTruncates {
                frames,
                bytes,
                reported,
            } => self.cuts = Some((*frames, usize::from(*bytes), *reported)),
            Action::RunSequence { seed } => {
                if self.sequence.as_ref().is_none_or(SequenceRun::is_over) {
                    self.sequence = SequenceRun::random(*seed, &self.motors, self.now);
                    self.runs.started += u64::from(self.sequence.is_some());
                }
            }
        }
        self.run(Duration::ZERO)
    }

    fn set_line(&mut self, line: LineFault) {
        self.line = line;
        self.world.set_faults(line.faults());
        self.rules.line(self.now, line == LineFault::None);
    }

    /// Does what is due for the run.
    fn turn_sequence(&mut self) -> Result<(), Violation> {
        let is_due = |run: &SequenceRun| run.wake().is_some_and(|wake| wake <= self.now);
        if self.sequence.as_ref().is_some_and(is_due) {
            self.with_sequence(|run, now, bus, settings, page_answers| {
                run.turn(now, bus, settings, page_answers)
            })?;
        }
        Ok(())
    }

    /// Lets the run act, and judges what it has done.
    fn with_sequence(
        &mut self,
        act: impl FnOnce(&mut SequenceRun, Instant, Option<&mut Bus>, BusSettings, bool) -> Answers,
    ) -> Result<(), Violation> {
        let Some(mut run) = self.sequence.take() else {
            return Ok(());
        };
        let was_over = run.end().is_some() || run.has_died();
        let bus = self.bus.as_mut();
        let answers = act(&mut run, self.now, bus, self.settings, self.page_answers);
        self.judge_answers(answers)?;
        if !was_over && (run.end().is_some() || run.has_died()) {
            match run.end() {
                Some(end) => self.runs.count(end),
                None => self.runs.by_trap += 1,
            }
            // A run that was never started stops nothing: a person may drive.
            if run.has_driven() {
                self.ended_run_drives_nothing(&run)?;
            }
        }
        self.sequence = Some(run);
        Ok(())
    }

    fn judge_answers(&mut self, answers: Answers) -> Result<(), Violation> {
        for (command, answer) in answers {
            self.note(|| format!("run: {command:?} {answer:?}"));
            if let Some(bus) = &self.bus {
                let now = self.now;
                self.rules
                    .on_command(now, now, command, answer, bus, &self.world)?;
            }
        }
        Ok(())
    }

    /// An ended run has stopped all of its motors.
    fn ended_run_drives_nothing(&self, run: &SequenceRun) -> Result<(), Violation> {
        let Some(bus) = &self.bus else {
            return Ok(());
        };
        let is_driven = |status: &MotorStatus| {
            run.moves(status.id) && matches!(status.activity, Activity::Driven { .. })
        };
        match bus.motors(self.now).find(is_driven) {
            None => Ok(()),
            Some(status) => Err(Violation {
                rule: Rule::DrivenByCommandOnly,
                at: self.now,
                what: format!("{} is driven after its run has ended", status.id),
            }),
        }
    }

    /// No call reaches the bus for a while; then it gets the pending inputs in this order.
    fn away(&mut self, duration: Duration, pending: &[PendingInput]) -> Result<(), Violation> {
        self.now = self.now + duration;
        self.advance()?;
        let late = self
            .promised
            .map_or(Duration::ZERO, |promised| self.now.since(promised));
        let is_driven_late = self.bus.is_some() && late > LATE_MAX;
        self.rules.on_absence(self.now, is_driven_late, &self.world);
        self.rules.passed(self.now, &self.world)?;
        for turn in pending {
            self.note(|| format!("{turn:?}"));
            match turn {
                PendingInput::Pong => {
                    if let Some(bus) = self.bus.as_mut().filter(|_| self.page_answers) {
                        bus.page_answered(self.now);
                    }
                }
                PendingInput::Bytes => {
                    let chunks = std::iter::from_fn(|| self.world.receive(self.now));
                    let bytes: Vec<u8> = chunks.flat_map(|chunk| chunk.bytes).collect();
                    if !bytes.is_empty() {
                        self.hand_over(&bytes);
                    }
                }
                PendingInput::Poll => {
                    self.settle()?;
                }
                PendingInput::Command { command, age } if self.page_answers => {
                    self.issue(self.now - *age, *command)?;
                }
                PendingInput::Command { command, age } => {
                    self.clicked.push((self.now - *age, *command));
                }
            }
        }
        Ok(())
    }

    /// Advances the world to now and checks its motors.
    fn advance(&mut self) -> Result<(), Violation> {
        self.world.advance(self.now);
        self.rules.moved(self.now, &self.world)?;
        self.receive_replies();
        Ok(())
    }

    /// Delivers bytes to the bus, if there is one.
    fn hand_over(&mut self, bytes: &[u8]) {
        if let Some(bus) = &mut self.bus {
            self.rules.delivered(self.now, bytes);
            bus.receive(self.now, bytes);
        }
    }

    /// Delivers the clicks of the meantime, before or after the answer to the ping.
    fn page_goes_on(&mut self) -> Result<(), Violation> {
        self.page_answers = true;
        self.rules.page(self.now, true);
        let clicked = std::mem::take(&mut self.clicked);
        let clicks_first = clicked.len().is_multiple_of(2);
        if !clicks_first && let Some(bus) = &mut self.bus {
            bus.page_answered(self.now);
        }
        for (given, command) in clicked {
            self.command(given, command)?;
        }
        if let Some(bus) = &mut self.bus {
            bus.page_answered(self.now);
        }
        Ok(())
    }

    /// A command of the operator, given at `given`. As in the worker, a command that is too old is
    /// dropped.
    fn command(&mut self, given: Instant, command: Command) -> Result<(), Violation> {
        self.issue(given, command)?;
        self.run(Duration::ZERO)
    }

    fn issue(&mut self, given: Instant, mut command: Command) -> Result<(), Violation> {
        if let Command::Configure(settings) = command {
            self.settings = settings;
            let run = self.sequence.as_ref();
            command = Command::Configure(run.map_or(settings, |run| run.settings(settings)));
        }
        if command.is_too_old(self.now.since(given)) {
            self.rules.judge(Rule::NoOldActs);
            return Ok(());
        }
        if self.bus.is_none() {
            return Ok(());
        }
        let mut ends_run = None;
        self.with_sequence(|run, now, bus, settings, _| match bus {
            Some(bus) => {
                let (input, answers) = run.before_command(now, command, bus, settings);
                ends_run = input;
                answers
            }
            None => Answers::new(),
        })?;
        if let Some(bus) = &mut self.bus {
            let answer = bus.command(self.now, command);
            self.rules
                .on_command(self.now, given, command, answer, bus, &self.world)?;
        }
        if let Some(input) = ends_run {
            self.with_sequence(|run, now, bus, settings, _| match bus {
                Some(bus) => run.after_command(now, input, bus, settings),
                None => Answers::new(),
            })?;
        }
        Ok(())
    }

    /// Stops everything on a good line and checks that it stands and stays so.
    fn end(&mut self) -> Result<(), Violation> {
        (self.refuses, self.cuts) = (0, None);
        self.apply(&Action::Line(LineFault::None))?;
        for motor in self.world.motors_mut() {
            self.rules.loaded(motor.id());
            motor.set_load_nm(0.0);
            motor.set_temperature_c(30.0);
            // A motor without supply would coast for too long.
            motor.power(true);
        }
        self.rules.heated(self.now);
        self.apply(&Action::PageHangs(false))?;
        self.apply(&Action::Replug)?;
        // A bus stops the motors that have answered.
        self.run(REST)?;
        self.command(self.now, Command::StopAll(StopReason::Operator))?;
        self.run(LAST_STOP)?;
        self.every_wheel_stands()?;
        self.command(self.now, Command::Release)?;
        self.acted = 0;
        self.run(REST)?;
        self.every_wheel_stands()?;
        if self.acted > 0 {
            return self.restless(format!("{} frames after a release", self.acted));
        }
        Ok(())
    }

    /// A motor may keep its last command: it must be one that moves nothing. A motor whose new ID the page has not learned,
    /// since the line hid the answer or another computer came, is out of its reach.
    fn every_wheel_stands(&self) -> Result<(), Violation> {
        let bus = self.bus.iter();
        let known: Vec<MotorId> = bus
            .flat_map(|bus| bus.motors(self.now))
            .map(|it| it.id)
            .collect();
        let motors = self.world.motors();
        for motor in motors.filter(|motor| known.contains(&motor.id())) {
            let (speed_rpm, obeyed) = (motor.speed_rpm(), motor.obeyed());
            if speed_rpm.abs() >= STANDS_RPM {
                let what = format!("{} turns at {speed_rpm} rpm by {obeyed:?}", motor.id());
                return self.restless(what);
            }
        }
        Ok(())
    }

    fn restless(&self, what: String) -> Result<(), Violation> {
        Err(Violation {
            rule: Rule::ComesToRest,
            at: self.now,
            what,
        })
    }

    fn run(&mut self, duration: Duration) -> Result<(), Violation> {
        let end = self.now + duration;
        loop {
            self.turn_sequence()?;
            let wake = self.settle()?;
            self.rules.passed(self.now, &self.world)?;
            // An event may have ended the run.
            let run_wake = self.sequence.as_ref().and_then(SequenceRun::wake);
            let next = [Some(end), wake, self.world.next_event(), run_wake];
            let next = next.into_iter().flatten().min().unwrap_or(end);
            self.count_wake(wake.is_some_and(|wake| wake <= next))?;
            self.now = next.max(self.now);
            self.advance()?;
            while let Some(chunk) = self.world.receive(self.now) {
                self.hand_over(&chunk.bytes);
            }
            if self.now >= end {
                self.settle()?;
                return self.rules.passed(self.now, &self.world);
            }
        }
    }

    fn note(&mut self, what: impl FnOnce() -> String) {
        let now = self.now;
        if let Some(passed) = &mut self.passed {
            if passed.len() == passed.capacity() {
                passed.pop_front();
            }
            passed.push_back(format!("{now:?}  {}", what()));
        }
    }

    fn count_wake(&mut self, is_wake: bool) -> Result<(), Violation> {
        let (began, count) = &mut self.wakes;
        if self.now.since(*began) >= Duration::from_secs(1) {
            (*began, *count) = (self.now, 0);
        }
        *count += u32::from(is_wake);
        if *count > WAKES_A_SECOND_MAX {
            return self.restless("the bus asks to be woken again and again".to_owned());
        }
        Ok(())
    }

    /// Passes the replies of the motors to the rules.
    fn receive_replies(&mut self) {
        let is_heard = self.bus.is_some();
        let passed: Vec<_> = self.world.drain_wire_frames().collect();
        for traffic in passed {
            if let Sender::Motor(_) = traffic.from {
                self.rules.said(traffic.at, traffic.frame);
                if is_heard {
                    self.rules.replied(traffic.at, traffic.frame, &self.world);
                }
            }
        }
    }

    /// Polls the bus. Returns when to poll it again.
    fn settle(&mut self) -> Result<Option<Instant>, Violation> {
        for _ in 0..STEPS_AT_ONCE_MAX {
            let Some(bus) = &mut self.bus else {
                return Ok(None);
            };
            match bus.poll(self.now) {
                Output::Transmit(frame) => self.transmit(frame)?,
                Output::Event(Event::PingPage) if self.page_answers => bus.page_answered(self.now),
                Output::Event(event) => {
                    self.note(|| format!("{event:?}"));
                    self.rules.on_event(self.now, &event, &self.world)?;
                    self.with_sequence(|run, now, bus, settings, _| match bus {
                        Some(bus) => run.on_event(now, &event, bus, settings),
                        None => Answers::new(),
                    })?;
                }
                Output::Wait(at) if at > self.now => {
                    self.rules.settled(self.now, bus, &self.world)?;
                    self.promised = Some(at);
                    return Ok(Some(at));
                }
                Output::Wait(_) => break,
            }
        }
        self.restless("the bus never rests".to_owned())
            .map(|()| None)
    }

    /// The port takes a frame, refuses it or truncates it.
    fn transmit(&mut self, frame: Frame) -> Result<(), Violation> {
        let Some(bus) = &mut self.bus else {
            return Ok(());
        };
        self.left_driven = bus.left_driven().collect();
        if let Some(left) = self.refuses.checked_sub(1) {
            self.refuses = left;
            bus.transmit_failed();
            self.rules.refused(self.now, frame, 0, true);
            return Ok(());
        }
        if let Some((frames @ 1.., bytes, reported)) = self.cuts {
            self.cuts = Some((frames - 1, bytes, reported));
            if reported {
                bus.transmit_failed();
            }
            self.rules.refused(self.now, frame, bytes, reported);
            let front = frame.bytes().get(..bytes).unwrap_or_default();
            self.world.transmit(self.now, front);
            return Ok(());
        }
        self.rules.sent(self.now, frame, bus, &self.world)?;
        let asks = match Request::parse(self.model, &frame) {
            Ok(Request::Query { .. } | Request::ModeQuery { .. } | Request::IdQuery) => true,
            // A motor that has lost its supply is made ready again, which moves nothing.
            Ok(
                Request::Enable { on: true, .. }
                | Request::SwitchMode {
                    mode: Mode::Velocity,
                    ..
                },
            ) => self.model.spec().needs_enable,
            _ => false,
        };
        self.acted += u64::from(!asks);
        self.world.transmit(self.now, frame.bytes());
        Ok(())
    }
}

/// A motor of a scenario.
fn motor(scenario: &Scenario, id: MotorId) -> MotorConfig {
    let default = MotorConfig::of(scenario.model, id);
    let mode_switch_frames = if scenario.need_five_switches.contains(&id) {
        MANY_SWITCHES
    } else {
        default.mode_switch_frames
    };
    MotorConfig {
        mode_switch_frames,
        obeys_all: scenario.obey_all,
        angle_deg: scenario.angle_deg,
        speed_stuck_rpm: scenario.speed_stuck.contains(&id).then_some(STUCK_RPM),
        when_silent: scenario.when_silent,
        ..default
    }
}
