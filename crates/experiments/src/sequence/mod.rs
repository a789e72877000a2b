//! A sequence: steps, each with a setpoint in its shape and an end.

mod csv;
mod error;
mod fields;
mod read;
mod schema;
mod template;
mod write;

use std::time::Duration;

use motorlink_protocol::{Acceleration, MotorId};

pub use csv::from_csv;
pub use error::{Problem, SequenceError};
pub use schema::schema;
pub use template::Template;

/// The version of the file format that this program reads and writes.
pub const VERSION: f64 = 1.0;
/// Most steps of a sequence. A table of ten thousand rows is what an imported recording of three
/// minutes at 50 Hz has; beyond it nobody reads the table.
pub const STEPS_MAX: usize = 10_000;
/// Most passes of one repeat.
pub const PASSES_MAX: u32 = 10_000;
/// Deepest nesting of repeats.
pub const DEPTH_MAX: usize = 4;
/// Longest run: a day, as an endurance test has.
pub const RUN_MAX: Duration = Duration::from_secs(24 * 3600);
/// Highest frequency of a sine, triangle or chirp: ten setpoints a period at 500 Hz.
pub const HZ_MAX: f64 = 50.0;
/// Lowest frequency: a period of 1000 s.
pub const HZ_MIN: f64 = 0.001;
/// Largest current: above 25,000 raw a person is asked, and in a run there is no one to ask.
pub const AMPS_MAX: f64 = 6.1;
/// The largest angle.
pub const DEGREES_MAX: f64 = 360.0;
/// Highest temperature of a condition or a limit: there the motor protects itself.
pub const CELSIUS_MAX: f64 = 80.0;
/// Most characters of a name.
pub const NAME_MAX: usize = 64;

/// What runs: a name, limits that end the run, and steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sequence {
    /// For people.
    pub name: String,
    /// Crossing one ends the run.
    pub limits: RunLimits,
    /// In order.
    pub steps: Vec<Step>,
}

/// Limits of one run, beside those of the bus. `None` is no limit of this run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunLimits {
    /// Speed in rpm, without direction: one reply above it.
    pub rpm: Option<f64>,
    /// Current in A, without direction: every reply of half a second above it.
    pub amps: Option<f64>,
    /// Temperature in deg C: one reply above it.
    pub celsius: Option<f64>,
}

/// One row of the table.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// A setpoint for a time or until a condition holds.
    Move(Move),
    /// Steps that are run several times.
    Repeat(Repeat),
}

/// A setpoint with its shape, for one or more motors. The others keep their last setpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Whose setpoint it is.
    pub who: Who,
    /// What they are to do.
    pub demand: Demand,
    /// When the next step begins.
    pub end: End,
}

/// Whose setpoint a step is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Who {
    /// Every motor of the fleet.
    #[default]
    All,
    /// One motor.
    Motor(MotorId),
    /// The motors of a group, by its name.
    Group(String),
}

/// What a motor is to do. The quantity decides the loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// A value in its shape.
    Follow {
        /// What the values mean.
        quantity: Quantity,
        /// How the value goes over time.
        shape: Shape,
        /// How gently the motor follows a higher speed; velocity loop only.
        acceleration: Acceleration,
    },
    /// The electric brake, in the velocity loop.
    Brake,
}

/// What a setpoint is a value of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Speed: the velocity loop.
    Rpm,
    /// Torque current: the current loop. 0 A lets the wheel coast.
    Amps,
    /// Angle: the position loop.
    Degrees,
}

/// How a setpoint goes over the time of its step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// This value at once.
    Step {
        /// The value.
        to: f64,
    },
    /// From the setpoint before to this value, evenly over the step's time.
    Ramp {
        /// The value at the end.
        to: f64,
    },
    /// A sine that begins in the centre and rises.
    Sine(Wave),
    /// A triangle that begins in the centre and rises.
    Triangle(Wave),
    /// A sine whose frequency rises or falls evenly per octave over the step's time.
    Chirp {
        /// The sine at the beginning.
        wave: Wave,
        /// Frequency at the end.
        to_hz: f64,
    },
}

/// A periodic setpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// The value in the middle.
    pub centre: f64,
    /// How far it goes to either side.
    pub amplitude: f64,
    /// Periods a second.
    pub hz: f64,
}

/// When a step ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// After this time. Zero goes on at once.
    After(f64),
    /// When the condition holds for every motor of the step. If it does not within this time, the run is
    /// aborted.
    Until {
        /// What is waited for.
        condition: Condition,
        /// In seconds.
        within_s: f64,
    },
}

/// A condition of telemetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// Speed without direction is this or more.
    RpmAbove(f64),
    /// Speed without direction is this or less.
    RpmBelow(f64),
    /// The reported angle is this near, the shorter way round.
    DegreesNear {
        /// The angle.
        degrees: f64,
        /// Tolerance to either side.
        tolerance: f64,
    },
    /// The winding has this temperature or more.
    CelsiusAbove(f64),
    /// The winding has this temperature or less.
    CelsiusBelow(f64),
}

/// Steps that are run several times.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeat {
    /// How often; also with a condition, so that every loop ends.
    pub passes: u32,
    /// After a pass in which this holds for any motor of the run there is no other.
    pub until: Option<Condition>,
    /// What is repeated.
    pub steps: Vec<Step>,
}

impl Quantity {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Rpm, Self::Amps, Self::Degrees];

    /// Its field in a file.
    #[must_use]
    pub const fn field(self) -> &'static str {
        match self {
            Self::Rpm => "rpm",
            Self::Amps => "amps",
            Self::Degrees => "degrees",
        }
    }
}

impl Shape {
    /// Its name in a file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Step { .. } => "step",
            Self::Ramp { .. } => "ramp",
            Self::Sine(_) => "sine",
            Self::Triangle(_) => "triangle",
            Self::Chirp { .. } => "chirp",
        }
    }

    /// The value at `t_s` of a step of `for_s` that began at the setpoint `from`. Past its end a shape
    /// keeps its last value.
    #[must_use]
    pub fn value(self, from: f64, t_s: f64, for_s: f64) -> f64 {
        let t_s = t_s.clamp(0.0, for_s);
        match self {
            Self::Ramp { to } if for_s > 0.0 => from + (to - from) * (t_s / for_s),
            Self::Step { to } | Self::Ramp { to } => to,
            Self::Sine(wave) => {
                wave.centre + wave.amplitude * (std::f64::consts::TAU * wave.hz * t_s).sin()
            }
            Self::Triangle(wave) => {
                let turn = (wave.hz * t_s + 0.25).rem_euclid(1.0);
                wave.centre + wave.amplitude * (1.0 - 4.0 * (turn - 0.5).abs())
            }
            Self::Chirp { wave, to_hz } => {
                let turns = chirp_turns(wave.hz, to_hz, t_s, for_s);
                wave.centre + wave.amplitude * (std::f64::consts::TAU * turns).sin()
            }
        }
    }

    /// Least and greatest value, of a step that began at `from`.
    #[must_use]
    pub fn range(self, from: f64) -> (f64, f64) {
        match self {
            Self::Step { to } => (to, to),
            Self::Ramp { to } => (from.min(to), from.max(to)),
            Self::Sine(wave) | Self::Triangle(wave) | Self::Chirp { wave, .. } => {
                (wave.centre - wave.amplitude, wave.centre + wave.amplitude)
            }
        }
    }
}

/// Periods since the beginning of a chirp: the integral of `hz * (to_hz / hz) ^ (t / for_s)`.
fn chirp_turns(hz: f64, to_hz: f64, t_s: f64, for_s: f64) -> f64 {
    let octaves = (to_hz / hz).ln();
    if for_s <= 0.0 || octaves.abs() < 1e-9 {
        return hz * t_s;
    }
    hz * for_s / octaves * (octaves * t_s / for_s).exp_m1()
}

impl Step {
    /// This value for one motor and a time, as a table begins.
    #[must_use]
    pub fn hold(who: Who, quantity: Quantity, to: f64, for_s: f64) -> Self {
        Self::follow(who, quantity, Shape::Step { to }, End::After(for_s))
    }

    /// This shape at the motor's own acceleration.
    #[must_use]
    pub const fn follow(who: Who, quantity: Quantity, shape: Shape, end: End) -> Self {
        Self::Move(Move {
            who,
            demand: Demand::Follow {
                quantity,
                shape,
                acceleration: Acceleration::DEFAULT,
            },
            end,
        })
    }
}
