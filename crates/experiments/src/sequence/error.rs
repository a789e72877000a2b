//! Why a sequence is refused, and where.

use std::fmt;

use motorlink_protocol::{Mode, MotorId};

/// An error with its place in the file, such as `steps[3].rpm`.
#[derive(Clone, Debug, PartialEq)]
pub struct SequenceError {
    /// The place; empty for the file as a whole.
    pub place: String,
    /// What is wrong there.
    pub problem: Problem,
}

/// What is wrong at a place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// The text is not JSON from this line and column on.
    #[error("not JSON at line {line}, column {column}")]
    NotJson {
        /// From 1.
        line: usize,
        /// From 1.
        column: usize,
    },
    /// More bytes than a sequence can have.
    #[error("the file is too large for a sequence")]
    TooLarge,
    /// Written by a newer program.
    #[error("written by a newer version; update this page to read it")]
    NewerVersion,
    /// An unknown version, or none.
    #[error("not a sequence: \"motorlink_sequence\" must be 1")]
    NoVersion,
    /// The bytes of the file are no text.
    #[error("not text in UTF-8; save the file as CSV UTF-8")]
    NotText,
    /// A number with a mark for thousands, or one whose mark may be one.
    #[error(
        "this may be a number with a mark for thousands; write it without marks, or with one decimal mark in all rows"
    )]
    ThousandsMark,
    /// Another type was expected, which is named here.
    #[error("expected {0}")]
    Expected(&'static str),
    /// No field of this name belongs here.
    #[error("unknown field; check its spelling")]
    UnknownField,
    /// The field occurs twice.
    #[error("appears twice; keep one")]
    Twice,
    /// The field is missing.
    #[error("is missing")]
    Missing,
    /// The field cannot be combined with another one, which is named here.
    #[error("cannot be used with {0}")]
    NotWith(&'static str),
    /// Too large.
    #[error("{value} is above {max}")]
    Above {
        /// What is there.
        value: f64,
        /// What is allowed.
        max: f64,
    },
    /// Too small.
    #[error("{value} is below {min}")]
    Below {
        /// What is there.
        value: f64,
        /// What is allowed.
        min: f64,
    },
    /// A time in a CSV file that is before the previous one.
    #[error("times must rise from row to row")]
    TimeFalls,
    /// No such motor.
    #[error("no motor {} here; scan for it, or use another", .0.get())]
    UnknownMotor(MotorId),
    /// No such group.
    #[error("no group of this name; use \"motor\" or a group")]
    UnknownGroup,
    /// No motors to run with.
    #[error("no motor to run with; connect one")]
    NoMotors,
    /// More motors than the bus drives as one group.
    #[error("a run drives at most {max} motors")]
    TooManyMotors {
        /// The maximum.
        max: usize,
    },
    /// The motor is driven in another loop before.
    #[error("motor {} is driven in the {before} before; one run keeps each motor in one loop", .id.get())]
    OtherLoop {
        /// Which motor.
        id: MotorId,
        /// Its loop in the steps before.
        before: Mode,
    },
    /// A repeat without a number of passes.
    #[error("a loop without end; give the number of passes, 1 or more")]
    EndlessLoop,
    /// A repeat whose steps take no time.
    #[error("a loop whose steps take no time")]
    TimelessLoop,
    /// Repeats in repeats in repeats.
    #[error("repeats are nested deeper than {max}")]
    TooDeep {
        /// The maximum.
        max: usize,
    },
    /// Too many steps.
    #[error("more than {max} steps")]
    TooManySteps {
        /// The maximum.
        max: usize,
    },
    /// No step at all.
    #[error("no steps; add one")]
    NoSteps,
    /// The run could take longer than allowed.
    #[error("the run could take longer than {hours_max} hours")]
    RunTooLong {
        /// How long it may take.
        hours_max: u64,
    },
}

impl SequenceError {
    pub(crate) fn at(place: impl Into<String>, problem: Problem) -> Self {
        Self {
            place: place.into(),
            problem,
        }
    }
}

/// `steps[3].rpm: 400 is above 330`
impl fmt::Display for SequenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.place.is_empty() {
            self.problem.fmt(f)
        } else {
            write!(f, "{}: {}", self.place, self.problem)
        }
    }
}

impl std::error::Error for SequenceError {}
