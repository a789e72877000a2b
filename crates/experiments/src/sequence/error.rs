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
#[derive(Clone, Debug, PartialEq)]
pub enum Problem {
    /// The text is not JSON from this line and column on.
    NotJson {
        /// From 1.
        line: usize,
        /// From 1.
        column: usize,
    },
    /// More bytes than a sequence can have.
    TooLarge,
    /// Written by a newer program.
    NewerVersion,
    /// An unknown version, or none.
    NoVersion,
    /// The bytes of the file are no text.
    NotText,
    /// A number with a mark for thousands, or one whose mark may be one.
    ThousandsMark,
    /// Another type was expected, which is named here.
    Expected(&'static str),
    /// No field of this name belongs here.
    UnknownField,
    /// The field occurs twice.
    Twice,
    /// The field is missing.
    Missing,
    /// The field cannot be combined with another one, which is named here.
    NotWith(&'static str),
    /// Too large.
    Above {
        /// What is there.
        value: f64,
        /// What is allowed.
        max: f64,
    },
    /// Too small.
    Below {
        /// What is there.
        value: f64,
        /// What is allowed.
        min: f64,
    },
    /// A time in a CSV file that is before the previous one.
    TimeFalls,
    /// No such motor.
    UnknownMotor(MotorId),
    /// No such group.
    UnknownGroup,
    /// No motors to run with.
    NoMotors,
    /// More motors than the bus drives as one group.
    TooManyMotors {
        /// The maximum.
        max: usize,
    },
    /// The motor is driven in another loop before.
    OtherLoop {
        /// Which motor.
        id: MotorId,
        /// Its loop in the steps before.
        before: Mode,
    },
    /// A repeat without a number of passes.
    EndlessLoop,
    /// A repeat whose steps take no time.
    TimelessLoop,
    /// Repeats in repeats in repeats.
    TooDeep {
        /// The maximum.
        max: usize,
    },
    /// Too many steps.
    TooManySteps {
        /// The maximum.
        max: usize,
    },
    /// No step at all.
    NoSteps,
    /// The run could take longer than allowed.
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

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotJson { line, column } => {
                write!(f, "not JSON at line {line}, column {column}")
            }
            Self::TooLarge => f.write_str("the file is too large for a sequence"),
            Self::NewerVersion => {
                f.write_str("written by a newer version; update this page to read it")
            }
            Self::NoVersion => f.write_str("not a sequence: \"motorlink_sequence\" must be 1"),
            Self::NotText => f.write_str("not text in UTF-8; save the file as CSV UTF-8"),
            Self::ThousandsMark => f.write_str(
                "this may be a number with a mark for thousands; write it without marks, or with one decimal mark in all rows",
            ),
            Self::Expected(what) => write!(f, "expected {what}"),
            Self::UnknownField => f.write_str("unknown field; check its spelling"),
            Self::Twice => f.write_str("appears twice; keep one"),
            Self::Missing => f.write_str("is missing"),
            Self::NotWith(other) => write!(f, "cannot be used with {other}"),
            Self::Above { value, max } => write!(f, "{value} is above {max}"),
            Self::Below { value, min } => write!(f, "{value} is below {min}"),
            Self::TimeFalls => f.write_str("times must rise from row to row"),
            Self::UnknownMotor(id) => {
                write!(f, "no motor {} here; scan for it, or use another", id.get())
            }
            Self::UnknownGroup => f.write_str("no group of this name; use \"motor\" or a group"),
            Self::NoMotors => f.write_str("no motor to run with; connect one"),
            Self::TooManyMotors { max } => write!(f, "a run drives at most {max} motors"),
            Self::OtherLoop { id, before } => write!(
                f,
                "motor {} is driven in the {before} before; one run keeps each motor in one loop",
                id.get()
            ),
            Self::EndlessLoop => {
                f.write_str("a loop without end; give the number of passes, 1 or more")
            }
            Self::TimelessLoop => f.write_str("a loop whose steps take no time"),
            Self::TooDeep { max } => write!(f, "repeats are nested deeper than {max}"),
            Self::TooManySteps { max } => write!(f, "more than {max} steps"),
            Self::NoSteps => f.write_str("no steps; add one"),
            Self::RunTooLong { hours_max } => {
                write!(f, "the run could take longer than {hours_max} hours")
            }
        }
    }
}
