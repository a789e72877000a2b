//! Studies: what is asked of a motor, the sequence that asks it, and the figures of its answer.
//!
//! | module | idea |
//! |---|---|
//! | `parameter` | the parameters of a study with their ranges: one table for fields, checks and files |
//! | `spans` | when each step of a run began and ended |
//! | `step`, `frequency`, `friction`, `coast_down`, `heating`, `torque_speed`, `silence` | one study each |
//! | `file` | a study as JSON, so that a kept run can be evaluated again |
//!
//! # Example
//!
//! ```
//! use motorlink_experiments::study::{StepStudy, Study};
//! use motorlink_protocol::MotorId;
//!
//! let study = Study::Step(StepStudy::of(MotorId::FIRST));
//! assert!(!study.sequence().steps.is_empty());
//! ```

mod coast_down;
mod file;
mod frequency;
mod friction;
mod heating;
mod parameter;
mod silence;
mod spans;
mod step;
mod torque_speed;

use std::time::Duration;

use motorlink_protocol::{MotorId, family::Model};
use strum::{EnumDiscriminants, IntoStaticStr, VariantArray};

pub use coast_down::{CoastDownFindings, CoastDownStudy};
pub use frequency::{FrequencyFindings, FrequencyStudy};
pub use friction::{FrictionFindings, FrictionStudy};
pub use heating::{HeatingFindings, HeatingStudy};
pub use parameter::Parameter;
pub use silence::{SILENT_S, SilenceFindings, SilenceStudy};
pub use step::{StepFindings, StepGroup, StepRepeat, StepStudy};
pub use torque_speed::{TorqueSpeedFindings, TorqueSpeedStudy};

use crate::{
    analysis::{Trace, Tracking, tracking},
    plan::Fleet,
    runner::{Record, SilentSteps},
    sequence::{Problem, Sequence, SequenceError},
};

/// What a run asks.
#[derive(Clone, Debug, PartialEq, EnumDiscriminants)]
#[strum_discriminants(
    name(StudyKind),
    derive(IntoStaticStr, VariantArray),
    strum(serialize_all = "snake_case"),
    doc = "Which study it is."
)]
pub enum Study {
    /// A sequence of the user, without figures.
    Sequence(Sequence),
    /// How a motor goes from one speed to another.
    #[strum_discriminants(strum(serialize = "step_response"))]
    Step(StepStudy),
    /// Gain and phase of the velocity loop.
    #[strum_discriminants(strum(serialize = "frequency_response"))]
    Frequency(FrequencyStudy),
    /// Current by speed without load.
    Friction(FrictionStudy),
    /// Inertia and friction.
    CoastDown(CoastDownStudy),
    /// Temperature at a constant current.
    Heating(HeatingStudy),
    /// Speed by torque, while a person loads the wheel.
    TorqueSpeed(TorqueSpeedStudy),
    /// What a motor does when drive frames cease.
    #[strum_discriminants(strum(serialize = "when_frames_cease"))]
    Silence(SilenceStudy),
}

/// The figures and curves that follow from a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Findings {
    /// What each motor did.
    Sequence(Vec<MotorFindings>),
    /// See [`Study::Step`].
    Step(StepFindings),
    /// See [`Study::Frequency`].
    Frequency(FrequencyFindings),
    /// See [`Study::Friction`].
    Friction(FrictionFindings),
    /// See [`Study::CoastDown`].
    CoastDown(CoastDownFindings),
    /// See [`Study::Heating`].
    Heating(HeatingFindings),
    /// See [`Study::TorqueSpeed`].
    TorqueSpeed(TorqueSpeedFindings),
    /// See [`Study::Silence`].
    Silence(SilenceFindings),
}

/// What a motor did in a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorFindings {
    /// Which motor.
    pub motor: MotorId,
    /// Its signals.
    pub trace: Trace,
    /// How well it followed its setpoints; `None` without a reply to one.
    pub tracking: Option<Tracking>,
}

/// How a run was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Requests per second to each motor, including those without a reply.
    pub request_hz: f64,
    /// The current bound of the motor, in A, if known.
    pub amps_max: Option<f64>,
    /// Time that a frame occupies the line.
    pub airtime: Duration,
}

impl Measured {
    /// At this rate, with motors of this model. Only the stall current of the M0601 and DDSM115 is known.
    #[must_use]
    pub fn of(model: Model, request_hz: f64) -> Self {
        Self {
            request_hz,
            amps_max: (model == Model::Ddsm115).then_some(2.7),
            airtime: model.frame_airtime(),
        }
    }
}

impl Default for Measured {
    /// The default rate of a run, with a DDSM115.
    fn default() -> Self {
        Self::of(Model::Ddsm115, 200.0)
    }
}

impl StudyKind {
    /// All of them.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// Its name in a file.
    #[must_use]
    pub fn field(self) -> &'static str {
        self.into()
    }
}

impl Study {
    /// Which study it is.
    #[must_use]
    pub fn kind(&self) -> StudyKind {
        self.into()
    }

    /// A study of one motor with its default parameters; for [`StudyKind::Sequence`] an empty sequence.
    #[must_use]
    pub fn of(kind: StudyKind, motor: MotorId) -> Self {
        match kind {
            StudyKind::Sequence => Self::Sequence(Sequence::default()),
            StudyKind::Step => Self::Step(StepStudy::of(motor)),
            StudyKind::Frequency => Self::Frequency(FrequencyStudy::of(motor)),
            StudyKind::Friction => Self::Friction(FrictionStudy::of(motor)),
            StudyKind::CoastDown => Self::CoastDown(CoastDownStudy::of(motor)),
            StudyKind::Heating => Self::Heating(HeatingStudy::of(motor)),
            StudyKind::TorqueSpeed => Self::TorqueSpeed(TorqueSpeedStudy::of(motor)),
            StudyKind::Silence => Self::Silence(SilenceStudy::of(motor)),
        }
    }

    /// The motor that is studied; `None` for a sequence, which names its motors.
    #[must_use]
    pub const fn motor(&self) -> Option<MotorId> {
        match self {
            Self::Sequence(_) => None,
            Self::Step(study) => Some(study.motor),
            Self::Frequency(study) => Some(study.motor),
            Self::Friction(study) => Some(study.motor),
            Self::CoastDown(study) => Some(study.motor),
            Self::Heating(study) => Some(study.motor),
            Self::TorqueSpeed(study) => Some(study.motor),
            Self::Silence(study) => Some(study.motor),
        }
    }

    /// The parameters with their ranges, except the motor and the accelerations.
    pub fn parameters(&mut self) -> Vec<Parameter<'_>> {
        match self {
            Self::Sequence(_) | Self::Silence(_) => Vec::new(),
            Self::Step(study) => study.parameters(),
            Self::Frequency(study) => study.parameters(),
            Self::Friction(study) => study.parameters(),
            Self::CoastDown(study) => study.parameters(),
            Self::Heating(study) => study.parameters(),
            Self::TorqueSpeed(study) => study.parameters(),
        }
    }

    /// Checks the parameters of a study. A sequence is checked by [`Plan::new`](crate::plan::Plan::new).
    ///
    /// # Errors
    /// The place of the error is the name of the parameter, such as `from_rpm`.
    pub fn check(&self, fleet: &Fleet) -> Result<(), SequenceError> {
        if let Some(motor) = self.motor()
            && !fleet.motors.contains(&motor)
        {
            return Err(SequenceError::at("motor", Problem::UnknownMotor(motor)));
        }
        for parameter in self.clone().parameters() {
            parameter.check(fleet.rpm_max)?;
        }
        match self {
            Self::Step(study) => study.check(),
            Self::Frequency(study) => study.check(fleet.rpm_max),
            _ => Ok(()),
        }
    }

    /// The sequence that asks it.
    #[must_use]
    pub fn sequence(&self) -> Sequence {
        match self {
            Self::Sequence(sequence) => sequence.clone(),
            Self::Step(study) => study.sequence(),
            Self::Frequency(study) => study.sequence(),
            Self::Friction(study) => study.sequence(),
            Self::CoastDown(study) => study.sequence(),
            Self::Heating(study) => study.sequence(),
            Self::TorqueSpeed(study) => study.sequence(),
            Self::Silence(study) => study.sequence(),
        }
    }

    /// The steps of its sequence in which frames are withheld.
    #[must_use]
    pub fn silent_steps(&self) -> SilentSteps {
        match self {
            Self::Silence(_) => SilenceStudy::silent_steps(),
            _ => SilentSteps::NONE,
        }
    }

    /// The figures of a run of [`Study::sequence`]; of an aborted run, those of what was measured.
    #[must_use]
    pub fn evaluate(&self, record: &Record, measured: &Measured) -> Findings {
        match self {
            Self::Sequence(_) => Findings::Sequence(motors(record, measured.airtime)),
            Self::Step(study) => Findings::Step(study.evaluate(record, measured)),
            Self::Frequency(study) => Findings::Frequency(study.evaluate(record, measured)),
            Self::Friction(study) => Findings::Friction(study.evaluate(record)),
            Self::CoastDown(study) => Findings::CoastDown(study.evaluate(record)),
            Self::Heating(study) => Findings::Heating(study.evaluate(record)),
            Self::TorqueSpeed(study) => Findings::TorqueSpeed(study.evaluate(record)),
            Self::Silence(study) => Findings::Silence(study.evaluate(record)),
        }
    }
}

fn motors(record: &Record, airtime: Duration) -> Vec<MotorFindings> {
    // A record of each motor, so that the work does not grow with the product of motors and replies.
    let apart = record.by_motor().into_iter();
    apart
        .map(|(motor, record)| MotorFindings {
            motor,
            trace: Trace::with_airtime(&record, motor, airtime),
            tracking: tracking(&record, motor, airtime),
        })
        .collect()
}
