//! A sequence: steps, each with a setpoint, its shape and its end.

mod csv;
mod error;
pub(crate) mod fields;
mod read;
mod schema;
mod template;
mod write;

use std::time::Duration;

use motorlink_protocol::{Acceleration, MotorId};

pub use csv::{Decoder, from_csv, separator_of, text_of};
pub use error::{Problem, SequenceError};
pub use schema::schema;
pub use template::Template;

/// The version of the file format that this program reads and writes.
pub const VERSION: f64 = 1.0;
/// Maximal number of steps. An imported recording of three minutes at 50 Hz has ten thousand rows; a longer table is
/// not readable.
pub const STEPS_MAX: usize = 10_000;
/// Maximal passes of one repeat.
pub const PASSES_MAX: u32 = 10_000;
/// Deepest nesting of repeats.
pub const DEPTH_MAX: usize = 4;
/// Longest run: a day, as an endurance test has.
pub const RUN_MAX: Duration = Duration::from_secs(24 * 3600);
/// Highest frequency of a sine, triangle or chirp: ten setpoints a period at 500 Hz.
pub const HZ_MAX: f64 = 50.0;
/// Lowest frequency: a period of 1000 s.
pub const HZ_MIN: f64 = 0.001;
/// Largest current: above 25,000 raw the page asks the user, which is impossible in a run.
pub const AMPS_MAX: f64 = 6.1;
/// The largest angle.
pub const DEGREES_MAX: f64 = 360.0;
/// Highest temperature of a condition or a limit: at this one the motor protects itself.
pub const CELSIUS_MAX: f64 = 80.0;
/// Maximal number of characters of a name.
pub const NAME_MAX: usize = 64;

/// A sequence: a name, limits that end the run, and steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sequence {
    /// Name for the user.
    pub name: String,
    /// Exceeding one ends the run.
    pub limits: RunLimits,
    /// Steps in their order.
    pub steps: Vec<Step>,
}

/// Limits of one run, besides the limits of the bus. `None` is no limit.
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

/// A setpoint with its shape, for one or more motors. The other motors keep their last setpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// The motors.
    pub selection: Selection,
    /// Their setpoint.
    pub action: Action,
    /// When the next step begins.
    pub end: End,
}

/// The motors of a step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    /// Every motor of the fleet.
    #[default]
    All,
    /// One motor.
    Motor(MotorId),
    /// The motors of a group, by its name.
    Group(String),
}

/// What a motor does. The quantity determines the loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// A setpoint over time.
    Follow {
        /// The quantity of the values.
        quantity: Quantity,
        /// The value over time.
        shape: Shape,
        /// Acceleration of the motor towards a higher speed; velocity loop only.
        acceleration: Acceleration,
    },
    /// The electric brake, in the velocity loop.
    Brake,
}

/// The quantity of a setpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Speed: the velocity loop.
    Rpm,
    /// Torque current: the current loop. 0 A lets the wheel coast.
    Amps,
    /// Angle: the position loop.
    Degrees,
}

/// A setpoint over the time of its step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// This value at once.
    Step {
        /// The value.
        to: f64,
    },
    /// From the previous setpoint to this value, linearly over the step's time.
    Ramp {
        /// The value at the end.
        to: f64,
    },
    /// A sine that begins in the centre and rises.
    Sine(Wave),
    /// A triangle that begins in the centre and rises.
    Triangle(Wave),
    /// A sine whose frequency changes evenly per octave over the step's time.
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
    /// The deviation to each side.
    pub amplitude: f64,
    /// Periods per second.
    pub hz: f64,
}

/// When a step ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// After this time in seconds. Zero continues at once.
    After(f64),
    /// When the condition is fulfilled for every motor of the step. If it is not within this time, the run is
    /// aborted.
    Until {
        /// The condition.
        condition: Condition,
        /// Maximal time, in seconds.
        within_s: f64,
    },
}

/// A condition of telemetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// The magnitude of the speed is at least this.
    RpmAbove(f64),
    /// The magnitude of the speed is at most this.
    RpmBelow(f64),
    /// The reported angle is within a tolerance, the shorter way round. Of a DDSM210 or DDSM400 it is that of its odometry, a
    /// few times a second: a fast wheel passes a narrow tolerance between two reports.
    DegreesNear {
        /// The angle.
        degrees: f64,
        /// Tolerance to either side.
        tolerance: f64,
    },
    /// The winding has at least this temperature.
    CelsiusAbove(f64),
    /// The winding has at most this temperature.
    CelsiusBelow(f64),
}

/// Steps that are run several times.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeat {
    /// Number of passes; with a condition the maximum, so that every loop ends.
    pub passes: u32,
    /// If this is fulfilled for any motor of the run during a pass, no other pass follows.
    pub until: Option<Condition>,
    /// The repeated steps.
    pub steps: Vec<Step>,
}

impl Quantity {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Rpm, Self::Amps, Self::Degrees];

    /// Its field name in a file.
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

    /// The value at `t_s` of a step of `for_s` that began at the setpoint `from`. After its end a shape keeps its
    /// last value.
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

    /// Least and greatest value of a step that began at `from`.
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

/// Periods since the start of a chirp: the integral of `hz * (to_hz / hz) ^ (t / for_s)`.
fn chirp_turns(hz: f64, to_hz: f64, t_s: f64, for_s: f64) -> f64 {
    let octaves = (to_hz / hz).ln();
    if for_s <= 0.0 || octaves.abs() < 1e-9 {
        return hz * t_s;
    }
    hz * for_s / octaves * (octaves * t_s / for_s).exp_m1()
}

impl Step {
    /// A step that holds a value for a time, as in a new table.
    #[must_use]
    pub fn hold(selection: Selection, quantity: Quantity, to: f64, for_s: f64) -> Self {
        Self::follow(selection, quantity, Shape::Step { to }, End::After(for_s))
    }

    /// A step with this shape at the motor's own acceleration.
    #[must_use]
    pub const fn follow(selection: Selection, quantity: Quantity, shape: Shape, end: End) -> Self {
        Self::Move(Move {
            selection,
            action: Action::Follow {
                quantity,
                shape,
                acceleration: Acceleration::DEFAULT,
            },
            end,
        })
    }
}
