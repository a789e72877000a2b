//! A sequence that has been checked against the motors that are there.

mod check;
mod curve;

use motorlink_protocol::{Mode, MotorId};

pub use curve::{Curve, CurvePoint, POINTS_MAX};

use crate::sequence::{Condition, Demand, End, Quantity, RunLimits};

/// Highest speed that any motor is commanded, in rpm.
pub const RPM_MAX: f64 = 330.0;
/// Most motors of a run: as many as the bus drives as one group.
pub const MOTORS_MAX: usize = 16;

/// The motors and groups that are there.
#[derive(Clone, Debug, PartialEq)]
pub struct Fleet {
    /// Every motor that may be driven.
    pub motors: Vec<MotorId>,
    /// Groups by name. Motors that are not in [`Fleet::motors`] are left out of a run.
    pub groups: Vec<(String, Vec<MotorId>)>,
    /// Highest speed of the slowest model, in rpm.
    pub rpm_max: f64,
}

impl Fleet {
    /// These motors without groups, up to [`RPM_MAX`].
    pub fn of(motors: impl IntoIterator<Item = MotorId>) -> Self {
        Self {
            motors: motors.into_iter().collect(),
            groups: Vec::new(),
            rpm_max: RPM_MAX,
        }
    }
}

/// A sequence that may be run. There is none that breaks a rule of [`Plan::new`].
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
    /// Which motor.
    pub id: MotorId,
    /// Its loop for the whole run.
    pub quantity: Quantity,
    /// Least setpoint, in the unit of the quantity.
    pub least: f64,
    /// Greatest setpoint.
    pub greatest: f64,
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

/// A step with its motors by their number in [`Plan::motors`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlannedMove {
    pub(crate) motors: Vec<usize>,
    pub(crate) demand: Demand,
    pub(crate) end: End,
    /// As in `steps[3]`.
    pub(crate) place: String,
}

impl PlannedMove {
    /// How long the shape goes on. One that waits goes on as long as it may wait.
    pub(crate) const fn seconds(&self) -> f64 {
        match self.end {
            End::After(seconds) => seconds,
            End::Until { within_s, .. } => within_s,
        }
    }
}

impl Plan {
    /// The motors that it moves, with their loops and how far their setpoints go.
    #[must_use]
    pub fn motors(&self) -> &[PlanMotor] {
        &self.motors
    }

    /// How long it takes at most, in seconds.
    #[must_use]
    pub const fn longest_s(&self) -> f64 {
        self.longest_s
    }

    /// Whether it waits for something, and so may be over sooner.
    #[must_use]
    pub const fn has_conditions(&self) -> bool {
        self.has_conditions
    }

    /// The step of the file that an instruction is of, as in `steps[3]`; empty for none.
    #[must_use]
    pub fn place(&self, step: usize) -> &str {
        match self.program.get(step) {
            Some(Op::Move(step)) => &step.place,
            _ => "",
        }
    }

    /// What ends the run.
    #[must_use]
    pub const fn limits(&self) -> RunLimits {
        self.limits
    }
}
