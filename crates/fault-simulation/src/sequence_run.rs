//! A random sequence in a run with both of its sides, as the port worker joins them with the bus.

use std::{ops::AddAssign, time::Duration};

use fastrand::Rng;
use motorlink_bus::{Bus, BusSettings, Command, Consent, Event, GroupSetpoints, Refusal, Withheld};
use motorlink_experiments::{
    plan::{Fleet, Plan},
    runner::{Cause, End, Options, Phase, SilentSteps},
    sequence::{
        Action, Condition, End as StepEnd, Move, Quantity, Repeat, Selection, Sequence, Shape,
        Step, Wave,
    },
};
use motorlink_messages::{
    encode,
    runs::{FromRun, ToRun},
};
use motorlink_protocol::{Acceleration, Instant, Mode, MotorId};
use motorlink_runs::{Host, Input, Line, Program};

/// How often the person acts: motors may still be switching their loop, or the line is busy.
const ACTS_EVERY: Duration = Duration::from_millis(50);
/// How long the person waits until the motors have switched their loop.
const SWITCHED_AFTER: Duration = Duration::from_millis(500);
/// A person who could not start for so long gives up.
const GIVES_UP_AFTER: Duration = Duration::from_secs(5);

/// How runs ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Runs {
    /// Had a person who wanted to arm them.
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
    /// Ended because the program of the run trapped.
    pub by_trap: u64,
}

impl Runs {
    pub(crate) fn count(&mut self, end: End) {
        let counted = match end {
            End::Finished { .. } => &mut self.finished,
            End::Aborted { cause, .. } => match cause {
                Cause::Stopped
                | Cause::Driven(_)
                | Cause::PortClosed
                | Cause::Scan
                | Cause::OtherModel => &mut self.by_person,
                Cause::Silent(_)
                | Cause::Fault(..)
                | Cause::Limit(..)
                | Cause::OtherLoop(..)
                | Cause::LeftDriven => &mut self.by_motor,
                Cause::WaitTimedOut { .. } | Cause::Refused(_) | Cause::PausedTooLong => {
                    &mut self.by_plan
                }
                Cause::Unplugged
                | Cause::TabClosed
                | Cause::PageSilent
                | Cause::OperatorLost
                | Cause::FocusLost
                | Cause::Slept
                | Cause::Late
                | Cause::ProgramFailed => &mut self.by_machine,
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
        self.by_trap += other.by_trap;
    }
}

/// A run with both of its sides, and the person who arms and starts it.
pub(crate) struct SequenceRun {
    program: Program,
    host: Host,
    rng: Rng,
    arm: ToRun,
    motors: Vec<MotorId>,
    mode: Mode,
    person: Person,
    person_acts: Option<Instant>,
    gives_up: Instant,
    /// When the program traps, if it does.
    traps: Option<Instant>,
    died: bool,
    end: Option<End>,
    has_driven: bool,
}

/// What the person does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Person {
    Arms,
    Switches,
    Starts,
    Pauses,
    Resumes,
}

/// The line of a run, with what the bus has answered.
struct Watched<'a> {
    bus: &'a mut Bus,
    answers: Answers,
}

/// The commands that a run has given to the bus, with the answers.
pub(crate) type Answers = Vec<(Command, Result<(), Refusal>)>;

impl Line for Watched<'_> {
    fn command(&mut self, now: Instant, command: Command) -> Result<(), Refusal> {
        let answer = self.bus.command(now, command);
        self.answers.push((command, answer));
        answer
    }

    fn follow_plan(&mut self, now: Instant, setpoints: &GroupSetpoints) -> Result<(), Refusal> {
        let answer = self.bus.follow_plan(now, setpoints);
        let setpoints = *setpoints;
        let consent = Consent::None;
        let command = Command::AdjustGroup { setpoints, consent };
        self.answers.push((command, answer));
        answer
    }

    fn withhold(
        &mut self,
        now: Instant,
        id: MotorId,
        time: Duration,
        withheld: Withheld,
    ) -> Result<(), Refusal> {
        self.bus.withhold(now, id, time, withheld)
    }

    fn drives(&self, now: Instant, id: MotorId) -> bool {
        self.bus.drives(now, id)
    }
}

impl SequenceRun {
    /// A random sequence for these motors, which a person arms next. Nothing if it breaks a rule of a plan.
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
        let fleet = Fleet::of(motors.iter().copied());
        let plan = Plan::new(&sequence, &fleet).ok()?;
        let options = Options {
            period: Duration::from_millis(rng.u64(2..=40)),
            stop_on_lost_focus: true,
            silent_steps: SilentSteps::NONE,
        };
        let traps = now + Duration::from_millis(rng.u64(500..5_000));
        Some(Self {
            program: Program::default(),
            host: Host::default(),
            motors: plan.motors().iter().map(|motor| motor.id).collect(),
            mode: quantity_mode(quantity),
            arm: ToRun::Arm {
                run: 1,
                sequence: sequence.to_json(),
                fleet,
                options,
            },
            person: Person::Arms,
            person_acts: Some(now),
            gives_up: now + GIVES_UP_AFTER,
            traps: (rng.u8(..10) == 0).then_some(traps),
            died: false,
            end: None,
            has_driven: false,
            rng,
        })
    }

    /// How the run ended.
    pub(crate) const fn end(&self) -> Option<End> {
        self.end
    }

    /// Whether it has driven a motor.
    pub(crate) const fn has_driven(&self) -> bool {
        self.has_driven
    }

    /// Whether nothing of it goes on.
    pub(crate) const fn is_over(&self) -> bool {
        self.wake().is_none()
    }

    /// Whether the motor is one of the run.
    pub(crate) fn moves(&self, id: MotorId) -> bool {
        self.motors.contains(&id)
    }

    /// When [`turn`](Self::turn) is next due.
    pub(crate) const fn wake(&self) -> Option<Instant> {
        match (self.host.wake(), self.person_acts) {
            (Some(tick), Some(acts)) if acts.as_micros() < tick.as_micros() => Some(acts),
            (None, acts) => acts,
            (tick, _) => tick,
        }
    }

    /// The settings of the bus.
    pub(crate) fn settings(&self, of_person: BusSettings) -> BusSettings {
        self.host.settings(of_person)
    }

    /// Everything that is due. A page that hangs sends nothing.
    pub(crate) fn turn(
        &mut self,
        now: Instant,
        mut bus: Option<&mut Bus>,
        of_person: BusSettings,
        page_answers: bool,
    ) -> Answers {
        let mut answers = Answers::new();
        if self.person_acts.is_some_and(|at| at <= now) {
            self.person_acts = Some(now + ACTS_EVERY);
            if page_answers {
                answers = self.person_acts(now, bus.as_deref_mut(), of_person);
            }
            if now >= self.gives_up && self.host.wake().is_none() {
                self.person_acts = None;
            }
        }
        if self.host.tick_due(now).is_some() {
            answers.extend(self.pass(now, Input::Tick, bus, of_person));
        }
        answers
    }

    /// What the person does on the page.
    fn person_acts(
        &mut self,
        now: Instant,
        bus: Option<&mut Bus>,
        of_person: BusSettings,
    ) -> Answers {
        if self.end.is_some() || self.died {
            self.person_acts = None;
        }
        // A start that is too old must start nothing: the rules find a motor that it drives.
        let is_old = self.rng.u8(..8) == 0;
        let message = match self.person {
            Person::Arms => self.arm.clone(),
            Person::Switches => {
                self.person = Person::Starts;
                self.person_acts = Some(now + SWITCHED_AFTER);
                let mode = self.mode;
                let switch = |id: &MotorId| Command::SwitchMode { id: *id, mode };
                let Some(bus) = bus else {
                    return Answers::new();
                };
                let mut line = Watched {
                    bus,
                    answers: Answers::new(),
                };
                for command in self.motors.iter().map(switch) {
                    // What is refused now may be accepted later.
                    let _ = line.command(now, command);
                }
                return line.answers;
            }
            Person::Starts if now >= self.gives_up => ToRun::Abort,
            Person::Starts => ToRun::Start { run: 1 },
            Person::Pauses => match self.rng.u8(..60) {
                0 => ToRun::Abort,
                1 => ToRun::FocusLost,
                2..5 => {
                    self.person = Person::Resumes;
                    ToRun::Pause
                }
                _ => return Answers::new(),
            },
            Person::Resumes => {
                self.person = Person::Pauses;
                ToRun::Resume
            }
        };
        let Ok(bytes) = encode(&message) else {
            return Answers::new();
        };
        let line = Host::line_state(now, bus.as_deref());
        let input = Input::Message {
            bytes,
            is_old,
            line,
        };
        self.pass(now, input, bus, of_person)
    }

    /// Passes an input, as the port worker does.
    fn pass(
        &mut self,
        now: Instant,
        input: Input,
        bus: Option<&mut Bus>,
        of_person: BusSettings,
    ) -> Answers {
        if self.died {
            return Answers::new();
        }
        let mut line = bus.map(|bus| Watched {
            bus,
            answers: Answers::new(),
        });
        let traps = self.traps.is_some_and(|at| at <= now);
        let program = &mut self.program;
        let call = |now, input: &Input| (!traps).then(|| program.handle(now, input));
        let passed = self.host.pass(now, input, line.as_mut(), of_person, call);
        self.died = passed.is_err();
        let answers = line.map_or_else(Answers::new, |line| line.answers);
        let starts = |(command, answer): &(Command, Result<(), Refusal>)| {
            matches!((command, answer), (Command::DriveGroup { .. }, Ok(())))
        };
        self.has_driven |= answers.iter().any(starts);
        for message in self.program.take_messages() {
            if let FromRun::State(state) = message {
                match (state.phase, self.person) {
                    (Phase::Armed { .. }, Person::Arms) => self.person = Person::Switches,
                    (Phase::Running, Person::Starts) => self.person = Person::Pauses,
                    (Phase::Ended(end), _) => self.end = Some(end),
                    _ => {}
                }
            }
        }
        answers
    }

    /// The bus reports something.
    pub(crate) fn on_event(
        &mut self,
        now: Instant,
        event: &Event,
        bus: &mut Bus,
        of_person: BusSettings,
    ) -> Answers {
        match self.host.input_of(event, bus.model()) {
            Some(input) => self.pass(now, input, Some(bus), of_person),
            None => Answers::new(),
        }
    }

    /// A person's command comes. One that drives stops the run before.
    pub(crate) fn before_command(
        &mut self,
        now: Instant,
        command: Command,
        bus: &mut Bus,
        of_person: BusSettings,
    ) -> (Option<Input>, Answers) {
        let input = self.host.ended_by(command);
        let mut line = Watched {
            bus,
            answers: Answers::new(),
        };
        if let Some(Input::Driven(_)) = input {
            self.host.stop(now, Some(&mut line), of_person);
        }
        (input, line.answers)
    }

    /// The bus has answered that command.
    pub(crate) fn after_command(
        &mut self,
        now: Instant,
        input: Input,
        bus: &mut Bus,
        of_person: BusSettings,
    ) -> Answers {
        self.pass(now, input, Some(bus), of_person)
    }

    /// The adapter is gone, and the bus with it.
    pub(crate) fn unplugged(&mut self, now: Instant, of_person: BusSettings) {
        if self.host.wake().is_some() {
            self.pass(now, Input::Unplugged, None, of_person);
        }
    }

    /// Whether the program has failed.
    pub(crate) const fn has_died(&self) -> bool {
        self.died
    }
}

const fn quantity_mode(quantity: Quantity) -> Mode {
    match quantity {
        Quantity::Rpm => Mode::Velocity,
        Quantity::Amps => Mode::Current,
        Quantity::Degrees => Mode::Position,
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
