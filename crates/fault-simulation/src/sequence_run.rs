//! A random sequence that the runner drives over the bus, as a worker does.

use std::{ops::AddAssign, time::Duration};

use fastrand::Rng;
use motorlink_bus::{Command, Consent, Event, GroupSetpoints, Refusal, StopReason, WithdrawReason};
use motorlink_experiments::{
    plan::{Fleet, Plan},
    runner::{Cause, End, ExceededLimit, Options, Phase, Runner, Telemetry, Tick},
    sequence::{
        Action, Condition, End as StepEnd, Move, Quantity, Repeat, Selection, Sequence, Shape,
        Step, Wave,
    },
};
use motorlink_protocol::{Acceleration, Instant, Mode, MotorId, Setpoint};

/// How often an armed run tries to start: its motors may still be switching their loop.
const START_EVERY: Duration = Duration::from_millis(50);

/// How runs ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Runs {
    /// Armed.
    pub started: u64,
    /// Came to their last step.
    pub finished: u64,
    /// Ended by a stop or a command of a person.
    pub by_person: u64,
    /// Ended by a motor: silence, a fault, a limit or another loop.
    pub by_motor: u64,
    /// Ended by the page, the port or the machine.
    pub by_machine: u64,
    /// Ended because a condition did not come to hold, or because the bus refused a setpoint.
    pub by_plan: u64,
}

impl Runs {
    pub(crate) fn count(&mut self, end: End) {
        let counted = match end {
            End::Finished { .. } => &mut self.finished,
            End::Aborted { cause, .. } => match cause {
                Cause::Stopped | Cause::Driven(_) => &mut self.by_person,
                Cause::Silent(_) | Cause::Fault(..) | Cause::Limit(..) | Cause::OtherLoop(..) => {
                    &mut self.by_motor
                }
                Cause::WaitTimedOut { .. } | Cause::Refused(_) | Cause::PausedTooLong => {
                    &mut self.by_plan
                }
                Cause::Unplugged
                | Cause::TabClosed
                | Cause::PageSilent
                | Cause::FocusLost
                | Cause::Slept
                | Cause::Late => &mut self.by_machine,
            },
        };
        *counted += 1;
    }
}

impl AddAssign for Runs {
    fn add_assign(&mut self, other: Self) {
        self.started += other.started;
        self.finished += other.finished;
        self.by_person += other.by_person;
        self.by_motor += other.by_motor;
        self.by_machine += other.by_machine;
        self.by_plan += other.by_plan;
    }
}

/// A run, and what it has asked of the bus.
pub(crate) struct SequenceRun {
    runner: Runner,
    /// Loops to switch to before the start.
    switches: Vec<(MotorId, Mode)>,
    /// The setpoints that the bus has taken.
    given: Option<Vec<(MotorId, Setpoint)>>,
    wake: Option<Instant>,
}

impl SequenceRun {
    /// A random sequence for these motors, armed. Nothing if it breaks a rule of a plan.
    pub(crate) fn random(seed: u64, motors: &[MotorId], now: Instant) -> Option<Self> {
        let mut rng = Rng::with_seed(seed);
        let quantity = if rng.u8(..3) == 0 {
            Quantity::Amps
        } else {
            Quantity::Rpm
        };
        let sequence = Sequence {
            steps: steps(&mut rng, quantity, motors, 2),
            ..Sequence::default()
        };
        let plan = Plan::new(&sequence, &Fleet::of(motors.iter().copied())).ok()?;
        let options = Options {
            period: Duration::from_millis(rng.u64(5..=40)),
            ..Options::default()
        };
        let moved = plan.motors().iter();
        let switches = moved.map(|motor| (motor.id, motor.mode())).collect();
        Some(Self {
            runner: Runner::arm(plan, options, now),
            switches,
            given: None,
            wake: Some(now),
        })
    }

    /// How the run ended.
    pub(crate) fn end(&self) -> Option<End> {
        match self.runner.phase() {
            Phase::Ended(end) => Some(end),
            _ => None,
        }
    }

    /// Whether it has driven a motor.
    pub(crate) const fn has_driven(&self) -> bool {
        self.given.is_some()
    }

    /// Whether the motor is one of the run.
    pub(crate) fn moves(&self, id: MotorId) -> bool {
        let mut moved = self.runner.plan().motors().iter();
        moved.any(|motor| motor.id == id)
    }

    /// When [`turn`](Self::turn) is next due.
    pub(crate) const fn wake(&self) -> Option<Instant> {
        self.wake
    }

    /// What the run asks of the bus now.
    pub(crate) fn turn(&mut self, now: Instant) -> Vec<Command> {
        if !self.switches.is_empty() {
            let switch = |(id, mode)| Command::SwitchMode { id, mode };
            return self.switches.drain(..).map(switch).collect();
        }
        if matches!(self.runner.phase(), Phase::Armed { .. }) {
            // What it refuses for now may be there later; a person presses again.
            let _ = self.runner.start(now);
        }
        match self.runner.tick(now) {
            Tick::Idle => {
                let is_armed = matches!(self.runner.phase(), Phase::Armed { until } if now < until);
                self.wake = is_armed.then(|| now + START_EVERY);
                Vec::new()
            }
            Tick::Drive { setpoints, next } => {
                self.wake = Some(next.max(now + Duration::from_micros(1)));
                self.drive(setpoints)
            }
            Tick::Stop(_) => {
                self.wake = None;
                let moved = self.runner.plan().motors().iter();
                moved.map(|motor| Command::Stop(motor.id)).collect()
            }
        }
    }

    fn drive(&mut self, setpoints: Vec<(MotorId, Setpoint)>) -> Vec<Command> {
        if self.given.as_ref() == Some(&setpoints) {
            return Vec::new();
        }
        let consent = Consent::None;
        let Ok(group) = GroupSetpoints::new(&setpoints) else {
            return Vec::new();
        };
        // Only the first of them starts motion: what was stopped is never started by the next tick.
        let command = if self.given.is_none() {
            Command::DriveGroup {
                setpoints: group,
                consent,
            }
        } else {
            Command::AdjustGroup {
                setpoints: group,
                consent,
            }
        };
        self.given = Some(setpoints);
        vec![command]
    }

    /// The bus has answered a command of the run.
    pub(crate) fn answered(&mut self, now: Instant, command: Command, answer: Result<(), Refusal>) {
        let drives = matches!(
            command,
            Command::DriveGroup { .. } | Command::AdjustGroup { .. }
        );
        if drives && answer.is_err() {
            self.end_by(now, Cause::Refused(self.first()));
        }
    }

    /// The bus reports something.
    pub(crate) fn on_event(&mut self, now: Instant, event: &Event) {
        match event {
            Event::Telemetry(sample) => {
                let had_ended = self.end().is_some();
                let reported = Telemetry::of(sample.at, &sample.reply);
                self.runner.telemetry(reported);
                if !had_ended && self.end().is_some() {
                    self.wake = Some(now);
                }
            }
            Event::Withdrawn { id, reason } => {
                let cause = match reason {
                    WithdrawReason::Silent | WithdrawReason::NotEnabled => Cause::Silent(*id),
                    WithdrawReason::Fault(faults) => Cause::Fault(*id, *faults),
                    WithdrawReason::OtherLoop { reported } => Cause::OtherLoop(*id, *reported),
                    WithdrawReason::Limit(_) => Cause::Limit(*id, ExceededLimit::OfBus),
                };
                self.end_by(now, cause);
            }
            Event::StopBegan(reason) if self.given.is_some() => {
                let cause = match reason {
                    StopReason::PageGone => Cause::TabClosed,
                    StopReason::PageSilent => Cause::PageSilent,
                    StopReason::PageHidden => Cause::FocusLost,
                    StopReason::ComputerSlept => Cause::Slept,
                    StopReason::LoopDelayed => Cause::Late,
                    _ => Cause::Stopped,
                };
                self.end_by(now, cause);
            }
            _ => {}
        }
    }

    /// A person's command was taken. One that drives or stops ends the run.
    pub(crate) fn commanded(&mut self, now: Instant, command: Command) {
        let cause = match command {
            // Another motor is no concern of the run.
            Command::Drive { id, .. }
            | Command::Adjust { id, .. }
            | Command::SwitchMode { id, .. }
            | Command::Stop(id)
            | Command::Hold(id)
                if !self.moves(id) =>
            {
                return;
            }
            Command::Stop(_) | Command::StopAll(_) | Command::Hold(_) => Cause::Stopped,
            command if command.may_move() => Cause::Driven(self.first()),
            _ => return,
        };
        self.end_by(now, cause);
    }

    /// The adapter is gone, and the bus with it.
    pub(crate) fn unplugged(&mut self, now: Instant) {
        self.end_by(now, Cause::Unplugged);
    }

    fn end_by(&mut self, now: Instant, cause: Cause) {
        if self.end().is_none() {
            self.runner.abort(now, cause);
            self.wake = Some(now);
        }
    }

    fn first(&self) -> MotorId {
        let first = self.runner.plan().motors().first();
        first.map_or(MotorId::FIRST, |motor| motor.id)
    }
}

fn steps(rng: &mut Rng, quantity: Quantity, motors: &[MotorId], depth: u8) -> Vec<Step> {
    let count = rng.usize(1..=5);
    (0..count)
        .map(|_| {
            if depth > 0 && rng.u8(..5) == 0 {
                let mut steps = steps(rng, quantity, motors, depth - 1);
                // A loop takes time.
                steps.push(Step::hold(Selection::All, quantity, 0.0, 0.05));
                Step::Repeat(Repeat {
                    passes: rng.u32(1..=4),
                    until: (rng.u8(..3) == 0).then(|| condition(rng)),
                    steps,
                })
            } else {
                step(rng, quantity, motors)
            }
        })
        .collect()
}

fn step(rng: &mut Rng, quantity: Quantity, motors: &[MotorId]) -> Step {
    let selection = match motors.get(rng.usize(..=motors.len())) {
        Some(id) => Selection::Motor(*id),
        None => Selection::All,
    };
    let scale = if quantity == Quantity::Amps {
        0.01
    } else {
        1.0
    };
    let value = f64::from(rng.i32(-100..=100)) * scale;
    let wave = Wave {
        centre: value,
        amplitude: f64::from(rng.u32(..=60)) * scale,
        hz: f64::from(rng.u32(1..=50)) / 10.0,
    };
    let shape = match rng.u8(..6) {
        0 => Shape::Ramp { to: value },
        1 => Shape::Sine(wave),
        2 => Shape::Triangle(wave),
        3 => Shape::Chirp { wave, to_hz: 8.0 },
        _ => Shape::Step { to: value },
    };
    let may_wait = !matches!(shape, Shape::Ramp { .. } | Shape::Chirp { .. });
    let seconds = f64::from(rng.u32(..=150)) / 100.0;
    let end = if may_wait && rng.u8(..4) == 0 {
        StepEnd::Until {
            condition: condition(rng),
            within_s: seconds,
        }
    } else {
        StepEnd::After(seconds)
    };
    let action = if quantity == Quantity::Rpm && rng.u8(..8) == 0 {
        Action::Brake
    } else {
        Action::Follow {
            quantity,
            shape,
            acceleration: if quantity == Quantity::Rpm {
                Acceleration::new(rng.u8(..4))
            } else {
                Acceleration::DEFAULT
            },
        }
    };
    Step::Move(Move {
        selection,
        action,
        end,
    })
}

fn condition(rng: &mut Rng) -> Condition {
    let rpm = f64::from(rng.u32(..=80));
    match rng.u8(..4) {
        0 => Condition::CelsiusAbove(f64::from(rng.u32(20..=80))),
        1 => Condition::RpmBelow(rpm),
        _ => Condition::RpmAbove(rpm),
    }
}
