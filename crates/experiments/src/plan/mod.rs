//! A plan: a sequence that was checked against the available motors.

mod check;
mod curve;

use std::fmt;

use motorlink_protocol::{Mode, MotorId};

pub use curve::{Curve, CurvePoint, POINTS_MAX};

use crate::sequence::{Action, Condition, End, Quantity, RunLimits};

/// Maximal speed command of any motor, in rpm.
pub const RPM_MAX: f64 = 330.0;
/// Maximal number of motors in a run: as many as the bus drives as one group.
pub const MOTORS_MAX: usize = 16;

/// The available motors and groups.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fleet {
    /// All motors that can be driven.
    pub motors: Vec<MotorId>,
    /// Groups by name. A run leaves out motors that are not in [`Fleet::motors`].
    pub groups: Vec<(String, Vec<MotorId>)>,
    /// Maximal speed of the slowest model, in rpm.
    pub rpm_max: f64,
    /// Motors that are mounted mirrored. A sequence and a record have the signs of the operator; the frames of these
    /// motors have the opposite sign of speed and current, and their angles count the other way. Motors of a position
    /// run have their own signs.
    pub mirrored: Vec<MotorId>,
}

impl Fleet {
    /// These motors without groups, with a speed up to [`RPM_MAX`].
    pub fn of(motors: impl IntoIterator<Item = MotorId>) -> Self {
        Self {
            motors: motors.into_iter().collect(),
            groups: Vec::new(),
            rpm_max: RPM_MAX,
            mirrored: Vec::new(),
        }
    }
}

/// A sequence that can be run. It breaks no rule of [`Plan::new`].
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub(crate) motors: Vec<PlanMotor>,
    pub(crate) program: Vec<Op>,
    pub(crate) limits: RunLimits,
    pub(crate) longest_s: f64,
    pub(crate) has_conditions: bool,
}

/// A motor of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanMotor {
    /// The motor.
    pub id: MotorId,
    /// Its quantity, and so its loop, for the whole run.
    pub quantity: Quantity,
    /// Least setpoint, in the unit of the quantity.
    pub least: f64,
    /// Greatest setpoint.
    pub greatest: f64,
    /// Whether its frames have the opposite sign of speed and current; never in a position run.
    pub mirrored: bool,
}

impl PlanMotor {
    /// The loop that the motor must be in.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        match self.quantity {
            Quantity::Rpm => Mode::Velocity,
            Quantity::Amps => Mode::Current,
            Quantity::Degrees => Mode::Position,
        }
    }
}

/// One instruction of a run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Op {
    Move(PlannedMove),
    /// Begins a loop.
    Loop {
        passes: u32,
    },
    /// Ends a pass of the loop that begins at `first`.
    Again {
        first: usize,
        until: Option<Condition>,
    },
}

/// A step with its motors as indices in [`Plan::motors`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlannedMove {
    pub(crate) motors: Vec<usize>,
    pub(crate) action: Action,
    pub(crate) end: End,
    /// Its place in the file, such as `steps[3]`.
    pub(crate) place: String,
}

impl PlannedMove {
    /// Duration in seconds; for a step with a condition, the longest.
    pub(crate) const fn seconds(&self) -> f64 {
        match self.end {
            End::After(seconds) => seconds,
            End::Until { within_s, .. } => within_s,
        }
    }
}

/// What moves: `motor 1 from 0 to 100 rpm, for at most 12.5 s`.
impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for motor in &self.motors {
            let (id, unit) = (motor.id.get(), motor.quantity.field());
            let (least, greatest) = (motor.least, motor.greatest);
            write!(f, "motor {id} from {least} to {greatest} {unit}, ")?;
        }
        write!(f, "for at most {:.1} s", self.longest_s)
    }
}

impl Plan {
    /// Its motors with their loops and the range of their setpoints.
    #[must_use]
    pub fn motors(&self) -> &[PlanMotor] {
        &self.motors
    }

    /// Maximal duration, in seconds.
    #[must_use]
    pub const fn longest_s(&self) -> f64 {
        self.longest_s
    }

    /// Whether it has conditions, which can make it shorter.
    #[must_use]
    pub const fn has_conditions(&self) -> bool {
        self.has_conditions
    }

    /// The place in the file of an instruction, such as `steps[3]`; empty if there is none.
    #[must_use]
    pub fn place(&self, step: usize) -> &str {
        match self.program.get(step) {
            Some(Op::Move(step)) => &step.place,
            _ => "",
        }
    }

    /// The limits that end the run.
    #[must_use]
    pub const fn limits(&self) -> RunLimits {
        self.limits
    }
}
