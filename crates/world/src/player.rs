//! Plays a story over virtual time, and gives every step to the rules.

use std::{collections::BTreeMap, time::Duration};

use motorlink_bus::{Bus, Command, Event, Output, StopReason};
use motorlink_protocol::{Instant, MotorId, Request};
use motorlink_simulator::{World, WorldConfig};

use crate::{
    act::{Act, Fault, LineFault},
    rules::{Rule, Rules, Violation},
    story::Story,
};

/// What the bus does at one moment is bounded: this is far above it, and far below a busy loop.
const STEPS_AT_ONCE_MAX: u32 = 2_000;
/// Behind the last act everything is stopped, and stands within this.
const LAST_STOP: Duration = Duration::from_secs(8);
/// Released, nothing but questions is heard for this long.
const REST: Duration = Duration::from_secs(1);
/// Below this a wheel stands.
const STANDS_RPM: f32 = 1.0;

/// How often each fault happened.
pub type Coverage = BTreeMap<Fault, u64>;

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
    for (step, act) in story.acts.iter().enumerate() {
        if let Some(fault) = act.fault() {
            *coverage.entry(fault).or_default() += 1;
        }
        let outcome = player.act(act);
        outcome.map_err(|violation| Failure { step, violation })?;
    }
    let ended = player.end();
    let step = story.acts.len();
    ended.map_err(|violation| Failure { step, violation })
}

struct Player {
    now: Instant,
    world: World,
    /// `None` while the adapter is unplugged.
    bus: Option<Bus>,
    /// Whether Stop all motors stands, which outlives the port.
    halted: bool,
    page_answers: bool,
    rules: Rules,
    motors: Vec<MotorId>,
    /// Frames that were sent since the last look, but questions.
    acted: u64,
}

impl Player {
    fn new(story: &Story) -> Self {
        let now = Instant::from_millis(1_000);
        let mut world = World::new(WorldConfig {
            seed: story.seed,
            ..WorldConfig::with_ids(story.motors.iter().copied())
        });
        world.advance(now);
        let mut player = Self {
            now,
            world,
            bus: None,
            halted: false,
            page_answers: true,
            rules: Rules::default(),
            motors: story.motors.clone(),
            acted: 0,
        };
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
        for id in &self.motors {
            // On a bus on which nothing drives this is not refused.
            let _: Result<(), _> = bus.command(self.now, Command::Watch(*id));
        }
        self.bus = Some(bus);
    }

    fn act(&mut self, act: &Act) -> Result<(), Violation> {
        match act {
            // A page that hangs hears no click.
            Act::Command(command) if self.page_answers => self.command(*command)?,
            Act::Command(_) => {}
            Act::Pause(duration) => self.run(*duration)?,
            Act::Line(line) => self.world.set_faults(line.faults()),
            Act::Power { id, on } => {
                if let Some(motor) = self.world.motor_mut(*id) {
                    motor.power(*on);
                }
            }
            Act::Load { id, tenths_nm } => {
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
            Act::PageHangs(hangs) => {
                self.page_answers = !hangs;
                self.rules.page(self.now, !hangs);
                if !hangs && let Some(bus) = &mut self.bus {
                    bus.page_answered(self.now);
                }
            }
            Act::PageGoes => self.command(Command::StopAll(StopReason::PageGone))?,
            Act::Unplug => {
                if let Some(mut bus) = self.bus.take() {
                    self.halted = bus.is_halted();
                    for event in bus.close(self.now) {
                        self.rules.told(self.now, &event, &self.world)?;
                    }
                    self.rules.port_lost();
                }
            }
            Act::Replug => {
                if self.bus.is_none() {
                    self.plug();
                }
            }
        }
        self.run(Duration::ZERO)
    }

    fn command(&mut self, command: Command) -> Result<(), Violation> {
        if let Some(bus) = &mut self.bus {
            let answer = bus.command(self.now, command);
            self.rules.commanded(self.now, command, answer, bus);
        }
        self.run(Duration::ZERO)
    }

    /// Stops everything on a good line, and looks whether it stands and stays so.
    fn end(&mut self) -> Result<(), Violation> {
        self.world.set_faults(LineFault::None.faults());
        for motor in self.world.motors_mut() {
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
        self.command(Command::StopAll(StopReason::Operator))?;
        self.run(LAST_STOP)?;
        for motor in self.world.motors() {
            if motor.speed_rpm().abs() >= STANDS_RPM {
                let what = format!("{} turns at {} rpm", motor.id(), motor.speed_rpm());
                return self.restless(what);
            }
        }
        self.command(Command::Release)?;
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
            self.rules.passed(self.now)?;
            let next = [Some(end), wake, self.world.next_event()];
            let next = next.into_iter().flatten().min().unwrap_or(end);
            self.now = next.max(self.now);
            self.world.advance(self.now);
            while let Some(chunk) = self.world.receive(self.now) {
                if let Some(bus) = &mut self.bus {
                    bus.receive(self.now, &chunk.bytes);
                }
            }
            if self.now >= end {
                self.settle()?;
                return self.rules.passed(self.now);
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
                Output::Transmit(frame) => {
                    self.rules.sent(self.now, frame, bus, &self.world)?;
                    let asks = matches!(
                        Request::parse(&frame),
                        Ok(Request::Query { .. } | Request::IdQuery)
                    );
                    self.acted += u64::from(!asks);
                    self.world.transmit(self.now, frame.bytes());
                }
                Output::Event(Event::PingPage) if self.page_answers => bus.page_answered(self.now),
                Output::Event(event) => self.rules.told(self.now, &event, &self.world)?,
                Output::Wait(at) if at > self.now => {
                    self.rules.keep_what_stands(self.now, bus);
                    return Ok(Some(at));
                }
                Output::Wait(_) => break,
            }
        }
        self.restless("the bus never rests".to_owned())
            .map(|()| None)
    }
}
