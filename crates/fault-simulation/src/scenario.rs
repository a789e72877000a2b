//! Generates a list of actions from a seed.

use std::{
    ops::{Range, RangeInclusive},
    time::Duration,
};

use fastrand::Rng;
use motorlink_bus::{BusSettings, Command, SetIdFrames, StopReason};
use motorlink_protocol::{AssignableId, MotorId, Setpoint, SpeedTarget, family::Model};
use motorlink_simulator::WhenSilent;

use crate::{
    action::{Action, LineFault},
    generator::{Generator, drive, pause_ms},
    of_model::in_terms_of,
};

/// Random draws per scenario: single actions, and sometimes a sequence of several.
const DRAWS: usize = 30;
/// One draw in this many is a sequence.
const SEQUENCE_EVERY: u8 = 6;
/// One action in this many is preceded by a sequence that is run.
const RUN_EVERY: usize = 12;
/// Sequences have random numbers of their own, so that the other actions of a seed stay as they are.
const SEQUENCES: u64 = 0x5E90_E4CE;
/// So have the losses of page and worker, and the firmware.
const LOSSES: u64 = 0x1055_0F1D;
const FIRMWARE: u64 = 0xF1E3_A4E5;
/// So have hostile lines, which only some scenarios have.
const HOSTILE: u64 = 0x4057_11E5;
/// One comes before one action in this many.
const HOSTILE_EVERY: u8 = 10;
/// A loss comes before one action in this many.
const LOSS_EVERY: u8 = 40;
/// So have lines that die and adapters that another computer gets, and what differs between motors.
const DEAD_LINES: u64 = 0xDEAD_11E5;
const MOTORS: u64 = 0x0030_7025;
/// One of them comes before one action in this many.
const DEAD_LINE_EVERY: u8 = 50;
/// So have adapters that become slow and stay so for a while.
const SLOW_ADAPTERS: u64 = 0x510_ADA7;
/// One comes before one action in this many.
const SLOW_ADAPTER_EVERY: u8 = 200;
/// How long such an adapter holds received bytes.
const HELD_MS: RangeInclusive<u8> = 4..=30;
/// How long a line is dead: it comes back during a stop that began on it, or long after.
const DEAD_MS: Range<u64> = 500..25_000;
/// In one world of this many, motors report no speed.
const STUCK_EVERY: u8 = 6;
/// Pauses after an action in milliseconds: from within an exchange to the end of any stop.
const PAUSES_MS: [u64; 8] = [0, 1, 3, 10, 30, 150, 700, 2_500];

/// A scenario: motors and actions.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The seed that generates it.
    pub seed: u64,
    /// The model of the motors.
    pub model: Model,
    /// The addresses on the line.
    pub motors: Vec<MotorId>,
    /// Motors that switch only after five mode switch frames.
    pub need_five_switches: Vec<MotorId>,
    /// Whether the motors obey drive frames to 0xC8.
    pub obey_all: bool,
    /// What the motors do when drive frames cease.
    pub when_silent: WhenSilent,
    /// Motors that report -0.1 rpm however fast they turn.
    pub speed_stuck: Vec<MotorId>,
    /// The angle of each wheel at the start, in degrees.
    pub angle_deg: f32,
    /// The actions in order.
    pub actions: Vec<Action>,
}

impl Scenario {
    /// The scenario of this seed for motors of this model.
    #[must_use]
    pub fn of(model: Model, seed: u64) -> Self {
        Self::from_seed(seed).for_model(model)
    }

    /// The same for another model.
    #[must_use]
    pub fn for_model(self, model: Model) -> Self {
        Self {
            actions: in_terms_of(model, self.actions),
            model,
            ..self
        }
    }

    /// The same for motors that do this when drive frames cease.
    #[must_use]
    pub fn when_silent(self, when_silent: WhenSilent) -> Self {
        Self {
            when_silent,
            ..self
        }
    }

    /// The scenario of this seed for DDSM115 motors.
    #[must_use]
    pub fn from_seed(seed: u64) -> Self {
        let scenario = Self::without_losses(seed).with_losses().with_dead_lines();
        scenario.with_slow_adapters()
    }

    fn without_losses(seed: u64) -> Self {
        let mut generator = Generator {
            rng: Rng::with_seed(seed),
            motors: Vec::new(),
            settings: BusSettings::default(),
        };
        let count = generator.rng.u8(1..=4);
        generator.motors = (1..=count).filter_map(|id| MotorId::new(id).ok()).collect();
        let obey_all = generator.rng.u8(..4) == 0;
        let need_five_switches = generator.some_motors();
        let mut actions = Vec::new();
        // An ID change needs a complete scan before it, which random pauses would rarely wait for.
        if let (1, Some(from), Some(to)) = (count, generator.motors.first(), another_id()) {
            actions.push(Action::Command(Command::FullScan));
            actions.push(Action::Pause(Duration::from_secs(5)));
            actions.push(Action::Command(Command::SetId {
                from: *from,
                to,
                frames: SetIdFrames::Five,
            }));
        }
        for _ in 0..DRAWS {
            if generator.rng.u8(..SEQUENCE_EVERY) == 0 {
                actions.extend(generator.sequence());
            } else {
                actions.push(generator.action());
            }
            let pause = PAUSES_MS.get(generator.rng.usize(..PAUSES_MS.len()));
            actions.push(pause_ms(pause.copied().unwrap_or_default()));
        }
        let mut rng = Rng::with_seed(seed ^ MOTORS);
        let angle_deg = rng.f32() * 360.0;
        let is_stuck = rng.u8(..STUCK_EVERY) == 0;
        let mut speed_stuck = generator.motors.clone();
        speed_stuck.retain(|_| is_stuck && rng.bool());
        Self {
            seed,
            model: Model::Ddsm115,
            motors: generator.motors,
            need_five_switches,
            obey_all,
            when_silent: firmware(seed),
            speed_stuck,
            angle_deg,
            actions,
        }
    }

    /// The same with pages that crash and workers that die, half of them while a wheel turns.
    fn with_losses(self) -> Self {
        let mut rng = Rng::with_seed(self.seed ^ LOSSES);
        let mut actions = Vec::new();
        for action in self.actions {
            if rng.u8(..LOSS_EVERY) == 0 {
                let place = rng.usize(..self.motors.len().max(1));
                let id = self.motors.get(place).copied().unwrap_or(MotorId::FIRST);
                let speed = Setpoint::velocity(SpeedTarget::clamped(rng.i32(-150..=150)));
                let back_after = Duration::from_millis(rng.u64(50..3_000));
                // An even number of actions, so that a model keeps its open loop: see `in_terms_of`.
                actions.extend([
                    if rng.bool() {
                        drive(id, speed)
                    } else {
                        Action::Line(LineFault::None)
                    },
                    pause_ms(rng.u64(1..900)),
                    if rng.bool() {
                        Action::PageCrashes { back_after }
                    } else {
                        Action::WorkerDies { back_after }
                    },
                    pause_ms(rng.u64(..2_500)),
                ]);
            }
            actions.push(action);
        }
        Self { actions, ..self }
    }

    /// The same with lines that die for a while, and adapters that another computer gets; half of them while a wheel turns.
    fn with_dead_lines(self) -> Self {
        let mut rng = Rng::with_seed(self.seed ^ DEAD_LINES);
        let mut actions = Vec::new();
        for action in self.actions {
            if rng.u8(..DEAD_LINE_EVERY) == 0 {
                let place = rng.usize(..self.motors.len().max(1));
                let id = self.motors.get(place).copied().unwrap_or(MotorId::FIRST);
                let speed = Setpoint::velocity(SpeedTarget::clamped(rng.i32(-150..=150)));
                // An even number of actions, as above.
                if rng.bool() {
                    actions.extend([
                        Action::Replug,
                        Action::PageHangs(false),
                        Action::Line(LineFault::None),
                        Action::Power { id, on: true },
                        Action::Command(Command::Release),
                        // A DDSM400 is enabled meanwhile.
                        pause_ms(2_500),
                        drive(id, speed),
                        pause_ms(rng.u64(1..900)),
                    ]);
                }
                actions.extend([
                    if rng.bool() {
                        let lasts = Duration::from_millis(rng.u64(DEAD_MS));
                        Action::LineDies { lasts }
                    } else {
                        let back_after = Duration::from_millis(rng.u64(50..3_000));
                        Action::AnotherComputer { back_after }
                    },
                    pause_ms(rng.u64(..4_000)),
                ]);
            }
            actions.push(action);
        }
        Self { actions, ..self }
    }

    /// The same with adapters that become slow while nothing else is wrong, half of them while wheels turn.
    fn with_slow_adapters(self) -> Self {
        let mut rng = Rng::with_seed(self.seed ^ SLOW_ADAPTERS);
        let mut actions = Vec::new();
        for action in self.actions {
            if rng.u8(..SLOW_ADAPTER_EVERY) == 0 {
                actions.extend([
                    Action::Replug,
                    Action::PageHangs(false),
                    Action::Line(LineFault::None),
                    Action::Command(Command::Release),
                ]);
                for id in &self.motors {
                    actions.push(Action::Power { id: *id, on: true });
                    actions.push(Action::Command(Command::Stop(*id)));
                }
                // A DDSM400 is enabled meanwhile.
                actions.push(pause_ms(2_500));
                let driven = if rng.bool() { self.motors.len() } else { 0 };
                for id in self.motors.iter().take(driven) {
                    let speed = Setpoint::velocity(SpeedTarget::clamped(rng.i32(-150..=150)));
                    actions.extend([drive(*id, speed), pause_ms(0)]);
                }
                actions.extend([
                    Action::Line(LineFault::Gathers(rng.u8(HELD_MS))),
                    // An even number of actions, as above.
                    pause_ms(0),
                    pause_ms(rng.u64(3_100..6_000)),
                ]);
            }
            actions.push(action);
        }
        Self { actions, ..self }
    }

    /// The scenario of this seed, in which random sequences are run as well. The motors are there and
    /// the line is good when one is armed; what happens then is as random as before.
    #[must_use]
    pub fn with_sequences(seed: u64) -> Self {
        let scenario = Self::without_losses(seed);
        let mut rng = Rng::with_seed(seed ^ SEQUENCES);
        let mut actions = Vec::new();
        for (place, action) in scenario.actions.into_iter().enumerate() {
            if place % RUN_EVERY == 0 {
                actions.extend([
                    Action::Replug,
                    Action::PageHangs(false),
                    Action::Line(LineFault::None),
                    Action::Command(Command::CancelJob),
                    Action::Command(Command::StopRaw),
                ]);
                let on = |id: &MotorId| Action::Power { id: *id, on: true };
                actions.extend(scenario.motors.iter().map(on));
                actions.push(Action::Command(Command::StopAll(StopReason::Operator)));
                actions.push(pause_ms(900));
                actions.push(Action::Command(Command::Release));
                actions.push(Action::RunSequence { seed: rng.u64(..) });
                actions.push(pause_ms(rng.u64(200..6_000)));
            }
            actions.push(action);
        }
        let scenario = Self {
            actions,
            ..scenario
        };
        scenario.with_losses().with_dead_lines()
    }

    /// The scenario of this seed with lines of bad adapters and pairs.
    #[must_use]
    pub fn on_hostile_lines(model: Model, seed: u64) -> Self {
        let scenario = Self::without_losses(seed).with_losses();
        let scenario = scenario.with_hostile_lines().with_dead_lines();
        scenario.for_model(model)
    }

    fn with_hostile_lines(self) -> Self {
        let mut rng = Rng::with_seed(self.seed ^ HOSTILE);
        let mut actions = Vec::new();
        for action in self.actions {
            if rng.u8(..HOSTILE_EVERY) == 0 {
                let level = if rng.bool() { 0xFF } else { 0 };
                let line = match rng.u8(..5) {
                    0 => LineFault::EchoesParts,
                    1 => LineFault::ByteBefore(level),
                    2 => LineFault::ByteAfter(level),
                    3 => LineFault::Blocks,
                    _ => LineFault::Floats,
                };
                // An even number of actions: see `in_terms_of`.
                actions.extend([Action::Line(line), pause_ms(rng.u64(..600))]);
            }
            actions.push(action);
        }
        Self { actions, ..self }
    }
}

fn firmware(seed: u64) -> WhenSilent {
    let drawn = Rng::with_seed(seed ^ FIRMWARE).choice(WhenSilent::ALL);
    drawn.unwrap_or_default()
}

fn another_id() -> Option<AssignableId> {
    AssignableId::new(MotorId::new(9).ok()?).ok()
}
