//! Generates processes and what happens to them from a seed.

use std::{fmt, time::Duration};

use fastrand::Rng;
use motorlink_bus::{BusSettings, Command, Consent, StopReason};
use motorlink_protocol::{MotorId, family::Model};
use motorlink_simulator::WhenSilent;
use strum::IntoStaticStr;

use crate::{generator::Generator, of_model::command_for};

/// Acts of a process: more make it longer, and no more likely to fail.
const ACTS: u8 = 14;
/// Pauses between acts in milliseconds: from within an exchange to longer than any stop.
const PAUSES_MS: [u64; 8] = [0, 1, 4, 20, 80, 250, 700, 1_800];

/// What happens to a process. As a text it is the name in the table.
#[derive(Clone, Copy, Debug, PartialEq, IntoStaticStr)]
pub enum Act {
    /// The program gives a command.
    Command(Command),
    /// The program asks for the state.
    AskStatus,
    /// The program answers nothing for so long, and gives no command.
    ProgramSilent(Duration),
    /// The adapter is unplugged for so long. The system may give its port another name then.
    Unplug(Duration),
    /// The system refuses to open the port for so long.
    PortRefuses(Duration),
    /// The port takes and gives nothing for so long.
    PortStalls(Duration),
    /// The disk takes nothing for so long.
    DiskFull(Duration),
    /// The process gets no processor time for so long.
    Frozen(Duration),
    /// The driver itself fails with its next frame.
    Fails,
    /// The process is killed.
    Kill,
    /// The program ends, or a signal ends it.
    End,
}

impl Act {
    /// Whether the program does it, which it does only once the port is open.
    pub(super) const fn is_of_program(self) -> bool {
        matches!(
            self,
            Self::Command(_) | Self::AskStatus | Self::ProgramSilent(_)
        )
    }
}

/// One process.
#[derive(Clone, Debug, PartialEq)]
pub struct Process {
    /// The model that the program asks for.
    pub model: Option<Model>,
    /// Each act, and the pause before it.
    pub acts: Vec<(Duration, Act)>,
    /// The pause after the process.
    pub pause: Duration,
}

/// Motors, and the processes that use them one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct DriverScenario {
    /// The seed that generates it.
    pub seed: u64,
    /// The model of the motors.
    pub model: Model,
    /// The addresses on the line.
    pub motors: Vec<MotorId>,
    /// What the motors do when drive frames cease.
    pub when_silent: WhenSilent,
    /// The processes. The last one has a good computer.
    pub processes: Vec<Process>,
}

impl fmt::Display for DriverScenario {
    /// One line for each act.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            seed,
            model,
            motors,
            when_silent,
            processes,
        } = self;
        writeln!(f, "seed {seed}, {model}, {when_silent:?}, with {motors:?}")?;
        for process in processes {
            writeln!(f, "a process that asks for {:?}", process.model)?;
            for (pause, act) in &process.acts {
                writeln!(f, "  after {pause:?}: {act:?}")?;
            }
            writeln!(f, "then {:?} without one", process.pause)?;
        }
        Ok(())
    }
}

impl DriverScenario {
    /// The scenario of this seed.
    #[must_use]
    pub fn of(seed: u64) -> Self {
        let mut rng = Rng::with_seed(seed);
        let model = *rng.choice(&Model::ALL).unwrap_or(&Model::Ddsm115);
        let count = rng.u8(1..=4);
        let motors = (1..=count).filter_map(|id| MotorId::new(id).ok()).collect();
        let when_silent = match rng.u8(..4) {
            0 => WhenSilent::CoastAfter(Duration::from_secs(2)),
            1 => WhenSilent::BrakeAfter(Duration::from_millis(500)),
            _ => WhenSilent::Keep,
        };
        let mut generator = Generator {
            rng,
            motors,
            settings: BusSettings::default(),
        };
        let mut processes = Vec::new();
        for _ in 0..generator.rng.u8(1..=2) {
            processes.push(process(&mut generator, model));
        }
        processes.push(Process {
            model: None,
            acts: vec![(Duration::from_secs(4), Act::End)],
            pause: Duration::from_secs(1),
        });
        Self {
            seed,
            model,
            motors: generator.motors,
            when_silent,
            processes,
        }
    }
}

fn process(generator: &mut Generator, model: Model) -> Process {
    let mut acts = Vec::new();
    for _ in 0..generator.rng.u8(2..=ACTS) {
        acts.push((pause(&mut generator.rng), act(generator, model)));
    }
    let last = if generator.rng.bool() {
        Act::End
    } else {
        Act::Kill
    };
    acts.push((pause(&mut generator.rng), last));
    let rng = &mut generator.rng;
    Process {
        model: rng.bool().then_some(model),
        acts,
        pause: Duration::from_millis(rng.u64(20..1_500)),
    }
}

fn pause(rng: &mut Rng) -> Duration {
    Duration::from_millis(*rng.choice(&PAUSES_MS).unwrap_or(&0))
}

fn act(generator: &mut Generator, model: Model) -> Act {
    let mut within = |ms| Duration::from_millis(generator.rng.u64(ms));
    let (short, long) = (within(1..300), within(300..4_000));
    let time = if generator.rng.bool() { short } else { long };
    match generator.rng.u8(..40) {
        0..=2 => Act::Unplug(time),
        3 => Act::PortRefuses(time),
        4..=5 => Act::PortStalls(time),
        6 => Act::DiskFull(time),
        7 => Act::Frozen(time),
        8..=9 => Act::ProgramSilent(time),
        10..=11 => Act::AskStatus,
        12 => Act::Fails,
        13 => Act::Kill,
        14 => Act::End,
        _ => Act::Command(command(generator, model)),
    }
}

/// A command of a program: mostly one that drives.
fn command(generator: &mut Generator, model: Model) -> Command {
    let id = generator.motor();
    let drawn = match generator.rng.u8(..10) {
        0..=4 => Command::Start {
            id,
            setpoint: generator.speed(),
            consent: Consent::None,
        },
        5 => Command::StopAll(StopReason::Operator),
        6 => Command::Release,
        _ => generator.command(id),
    };
    let is_open = model.has(motorlink_protocol::Mode::OpenLoop);
    match command_for(model, is_open, drawn) {
        // The simulation of the bus plays them. Here the motors keep their IDs, and frames by hand have no rule.
        Command::SetId { .. } | Command::SendRaw { .. } | Command::StopRaw => Command::Stop(id),
        other => other,
    }
}
