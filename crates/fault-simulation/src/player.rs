//! Plays a story over virtual time, and gives every step to the rules.

use std::{
    collections::{BTreeMap, VecDeque},
    ops::AddAssign,
    time::Duration,
};

use motorlink_bus::{Bus, Command, Event, Limits, Output, StopReason};
use motorlink_protocol::{Frame, Instant, MotorId, Request};
use motorlink_simulator::{MotorConfig, Speaker, World, WorldConfig};

use crate::{
    act::{Act, Fault, LineFault, Turn},
    rules::{Rule, Rules, Violation},
    story::Story,
};

/// What the bus does at one moment is bounded: this is far above it, and far below a busy loop.
const STEPS_AT_ONCE_MAX: u32 = 2_000;
/// No hand is quicker than this, and no system finds an adapter sooner. What the adapter held is gone then.
const PULLED_OUT_FOR: Duration = Duration::from_millis(300);
/// How often the bus asks to be woken in a second: four times an exchange, at the most that the line
/// carries.
const WAKES_A_SECOND_MAX: u32 = 2_400;
/// Behind the last act everything is stopped, and stands within this.
const LAST_STOP: Duration = Duration::from_secs(8);
/// Released, nothing but questions is heard for this long.
const REST: Duration = Duration::from_secs(1);
/// Below this a wheel stands.
const STANDS_RPM: f32 = 1.0;
/// Later than this after the moment that the bus asked for, whatever stood is withdrawn.
const LATE_MAX: Duration = Duration::from_millis(500);
/// Mode switches for a motor that needs many.
const MANY_SWITCHES: u8 = 5;

/// What happened in the stories that were played.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// How often each fault happened.
    pub faults: BTreeMap<Fault, u64>,
    /// How often each rule had something to judge.
    pub judged: BTreeMap<Rule, u64>,
}

impl AddAssign for Coverage {
    fn add_assign(&mut self, other: Self) {
        for (fault, times) in other.faults {
            *self.faults.entry(fault).or_default() += times;
        }
        for (rule, times) in other.judged {
            *self.judged.entry(rule).or_default() += times;
        }
    }
}

/// Where a story broke a rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The act, counted from 0, that was the last before.
    pub step: usize,
    /// What did not hold.
    pub violation: Violation,
}

/// Plays a story to its end, or to the first rule that does not hold.
///
/// # Errors
///
/// What did not hold, and where.
pub fn play(story: &Story, coverage: &mut Coverage) -> Result<(), Failure> {
    let mut player = Player::new(story);
    let mut count = |fault, times: usize| {
        if let Ok(times @ 1..) = u64::try_from(times) {
            *coverage.faults.entry(fault).or_default() += times;
        }
    };
    count(Fault::NeedsFiveSwitches, story.need_five_switches.len());
    count(Fault::ObeysAll, usize::from(story.obey_all));
    for (step, act) in story.acts.iter().enumerate() {
        if let Some(fault) = act.fault() {
            *coverage.faults.entry(fault).or_default() += 1;
        }
        let outcome = player.act(act);
        outcome.map_err(|violation| Failure { step, violation })?;
    }
    let ended = player.end();
    player.rules.judge(Rule::ComesToRest);
    for (rule, times) in &player.rules.judged {
        *coverage.judged.entry(*rule).or_default() += times;
    }
    let step = story.acts.len();
    ended.map_err(|violation| Failure { step, violation })
}

/// What passed in a story up to its end, or to the first rule that did not hold: the last lines of it.
#[must_use]
pub fn what_passed(story: &Story, lines: usize) -> Vec<String> {
    let mut player = Player::new(story);
    player.passed = Some(VecDeque::with_capacity(lines));
    for act in &story.acts {
        player.note(|| format!("{act:?}"));
        if player.act(act).is_err() {
            return player.passed.into_iter().flatten().collect();
        }
    }
    // Whether that breaks a rule is told elsewhere.
    let _ = player.end();
    player.passed.into_iter().flatten().collect()
}

struct Player {
    now: Instant,
    world: World,
    /// `None` while the adapter is unplugged.
    bus: Option<Bus>,
    /// Whether Stop all motors stands, which outlives the port.
    halted: bool,
    page_answers: bool,
    /// What was clicked while the page hung, and when.
    clicked: Vec<(Instant, Command)>,
    limits: Limits,
    rules: Rules,
    motors: Vec<MotorId>,
    /// Frames that were sent since the last look, but questions.
    acted: u64,
    /// When the second began, and how often the bus has asked to be woken in it.
    wakes: (Instant, u32),
    /// When the bus asked to be called again, at the latest.
    promised: Option<Instant>,
    /// Frames that the port will refuse.
    refuses: u8,
    /// Of how many frames the port will send only so many bytes, and whether it says so.
    cuts: Option<(u8, usize, bool)>,
    /// What passed, where somebody wants to know; no more lines than it was made for.
    passed: Option<VecDeque<String>>,
}

impl Player {
    fn new(story: &Story) -> Self {
        let now = Instant::from_millis(1_000);
        let mut world = World::new(WorldConfig {
            seed: story.seed,
            motors: story.motors.iter().map(|id| motor(story, *id)).collect(),
            ..WorldConfig::default()
        });
        world.advance(now);
        let mut player = Self {
            now,
            world,
            bus: None,
            halted: false,
            page_answers: true,
            clicked: Vec::new(),
            limits: Limits::default(),
            rules: Rules::default(),
            motors: story.motors.clone(),
            acted: 0,
            wakes: (now, 0),
            promised: None,
            refuses: 0,
            cuts: None,
            passed: None,
        };
        player.rules.line(now, true);
        player.plug();
        player
    }

    /// A new bus, as the worker makes one for a port that it has opened.
    fn plug(&mut self) {
        let mut bus = if self.halted {
            Bus::halted(self.now)
        } else {
            Bus::new(self.now)
        };
        let limits = Command::SetLimits(self.limits);
        let watched = self.motors.iter().copied().map(Command::Watch);
        self.rules.limits(self.limits);
        self.promised = None;
        for command in watched.chain([limits]) {
            // On a bus on which nothing drives this is not refused.
            let _: Result<(), _> = bus.command(self.now, command);
        }
        self.bus = Some(bus);
    }

    fn act(&mut self, act: &Act) -> Result<(), Violation> {
        match act {
            Act::Command(command) if self.page_answers => self.command(self.now, *command)?,
            // It is heard when the page goes on.
            Act::Command(command) => self.clicked.push((self.now, *command)),
            Act::Pause(duration) => self.run(*duration)?,
            Act::Line(line) => {
                self.world.set_faults(line.faults());
                self.rules.line(self.now, *line == LineFault::None);
            }
            Act::Power { id, on } => {
                if let Some(motor) = self.world.motor_mut(*id) {
                    motor.power(*on);
                }
            }
            Act::Load { id, tenths_nm } => {
                self.rules.loaded(*id);
                if let Some(motor) = self.world.motor_mut(*id) {
                    motor.set_load_nm(f32::from(*tenths_nm) / 10.0);
                }
            }
            Act::Heat { id, celsius } => {
                self.rules.heated(self.now);
                if let Some(motor) = self.world.motor_mut(*id) {
                    motor.set_temperature_c((*celsius).into());
                }
            }
            Act::PageHangs(true) => {
                self.page_answers = false;
                self.rules.page(self.now, false);
            }
            Act::PageHangs(false) => self.page_goes_on()?,
            Act::PageGoes => self.command(self.now, Command::StopAll(StopReason::PageGone))?,
            Act::Unplug => {
                if let Some(mut bus) = self.bus.take() {
                    self.halted = bus.is_halted();
                    for event in bus.close(self.now) {
                        self.rules.told(self.now, &event, &self.world)?;
                    }
                    self.rules.port_lost(self.now, &self.world);
                    self.run(PULLED_OUT_FOR)?;
                }
            }
            Act::Replug => {
                if self.bus.is_none() {
                    self.plug();
                }
            }
            Act::Away { lasts, then, .. } => self.away(*lasts, then)?,
            Act::Refuses { frames } => self.refuses = *frames,
            Act::Cuts {
                frames,
                bytes,
                told,
            } => self.cuts = Some((*frames, usize::from(*bytes), *told)),
        }
        self.run(Duration::ZERO)
    }

    /// Nobody calls the bus for a while; then all that waits is handed to it in this order.
    fn away(&mut self, lasts: Duration, then: &[Turn]) -> Result<(), Violation> {
        self.now = self.now + lasts;
        self.advance()?;
        let late = self
            .promised
            .map_or(Duration::ZERO, |promised| self.now.since(promised));
        let is_driven_late = self.bus.is_some() && late > LATE_MAX;
        self.rules.was_away(self.now, is_driven_late, &self.world);
        self.rules.passed(self.now, &self.world)?;
        for turn in then {
            self.note(|| format!("{turn:?}"));
            match turn {
                Turn::Pong => {
                    if let Some(bus) = self.bus.as_mut().filter(|_| self.page_answers) {
                        bus.page_answered(self.now);
                    }
                }
                Turn::Bytes => {
                    let chunks = std::iter::from_fn(|| self.world.receive(self.now));
                    let bytes: Vec<u8> = chunks.flat_map(|chunk| chunk.bytes).collect();
                    if !bytes.is_empty() {
                        self.hand_over(&bytes);
                    }
                }
                Turn::Poll => {
                    self.settle()?;
                }
                Turn::Command { command, age } if self.page_answers => {
                    self.give(self.now - *age, *command)?;
                }
                Turn::Command { command, age } => {
                    self.clicked.push((self.now - *age, *command));
                }
            }
        }
        Ok(())
    }

    /// The world comes to this moment, and the rules see what its motors do.
    fn advance(&mut self) -> Result<(), Violation> {
        self.world.advance(self.now);
        self.rules.moved(self.now, &self.world)?;
        self.hear_motors();
        Ok(())
    }

    /// Bytes reach the bus, where there is one.
    fn hand_over(&mut self, bytes: &[u8]) {
        if let Some(bus) = &mut self.bus {
            self.rules.delivered(self.now, bytes);
            bus.receive(self.now, bytes);
        }
    }

    /// What was clicked meanwhile is handed over, before or behind the answer to the ping.
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

    /// The operator asks for something at `given`. As in the worker, an act that comes late is not
    /// carried out.
    fn command(&mut self, given: Instant, command: Command) -> Result<(), Violation> {
        self.give(given, command)?;
        self.run(Duration::ZERO)
    }

    fn give(&mut self, given: Instant, command: Command) -> Result<(), Violation> {
        if let Command::SetLimits(limits) = command {
            self.limits = limits;
        }
        if command.is_too_old(self.now.since(given)) {
            self.rules.judge(Rule::NoOldActs);
        } else if let Some(bus) = &mut self.bus {
            let answer = bus.command(self.now, command);
            self.rules
                .commanded(self.now, given, command, answer, bus, &self.world)?;
        }
        Ok(())
    }

    /// Stops everything on a good line, and looks whether it stands and stays so.
    fn end(&mut self) -> Result<(), Violation> {
        (self.refuses, self.cuts) = (0, None);
        self.act(&Act::Line(LineFault::None))?;
        for motor in self.world.motors_mut() {
            self.rules.loaded(motor.id());
            motor.set_load_nm(0.0);
            motor.set_temperature_c(30.0);
            // One without supply would coast for longer than anybody waits.
            motor.power(true);
        }
        self.rules.heated(self.now);
        self.act(&Act::PageHangs(false))?;
        self.act(&Act::Replug)?;
        // A bus stops whom it has heard.
        self.run(REST)?;
        self.command(self.now, Command::StopAll(StopReason::Operator))?;
        self.run(LAST_STOP)?;
        for motor in self.world.motors() {
            if motor.speed_rpm().abs() >= STANDS_RPM {
                let what = format!("{} turns at {} rpm", motor.id(), motor.speed_rpm());
                return self.restless(what);
            }
        }
        self.command(self.now, Command::Release)?;
        self.acted = 0;
        self.run(REST)?;
        if self.acted > 0 {
            return self.restless(format!("{} frames after a release", self.acted));
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
            let wake = self.settle()?;
            self.rules.passed(self.now, &self.world)?;
            let next = [Some(end), wake, self.world.next_event()];
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

    /// Lets the rules know what the motors said.
    fn hear_motors(&mut self) {
        let is_heard = self.bus.is_some();
        let passed: Vec<_> = self.world.drain_traffic().collect();
        for traffic in passed {
            if is_heard && let Speaker::Motor(_) = traffic.from {
                self.rules.replied(traffic.at, traffic.frame, &self.world);
            }
        }
    }

    /// Lets the bus do what is due. Gives when it is to be asked again.
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
                    self.rules.told(self.now, &event, &self.world)?;
                }
                Output::Wait(at) if at > self.now => {
                    self.rules.settled(self.now, bus)?;
                    self.promised = Some(at);
                    return Ok(Some(at));
                }
                Output::Wait(_) => break,
            }
        }
        self.restless("the bus never rests".to_owned())
            .map(|()| None)
    }

    /// The port takes a frame, or not, or its front.
    fn transmit(&mut self, frame: Frame) -> Result<(), Violation> {
        let Some(bus) = &mut self.bus else {
            return Ok(());
        };
        if let Some(left) = self.refuses.checked_sub(1) {
            self.refuses = left;
            bus.transmit_failed();
            self.rules.refused(self.now, frame, 0, true);
            return Ok(());
        }
        if let Some((frames @ 1.., bytes, told)) = self.cuts {
            self.cuts = Some((frames - 1, bytes, told));
            if told {
                bus.transmit_failed();
            }
            self.rules.refused(self.now, frame, bytes, told);
            let front = frame.bytes().get(..bytes).unwrap_or_default();
            self.world.transmit(self.now, front);
            return Ok(());
        }
        self.rules.sent(self.now, frame, bus, &self.world)?;
        let asks = matches!(
            Request::parse(&frame),
            Ok(Request::Query { .. } | Request::IdQuery)
        );
        self.acted += u64::from(!asks);
        self.world.transmit(self.now, frame.bytes());
        Ok(())
    }
}

/// A motor of a story.
fn motor(story: &Story, id: MotorId) -> MotorConfig {
    let default = MotorConfig::new(id);
    let mode_switch_frames = if story.need_five_switches.contains(&id) {
        MANY_SWITCHES
    } else {
        default.mode_switch_frames
    };
    MotorConfig {
        mode_switch_frames,
        obeys_all: story.obey_all,
        ..default
    }
}
