//! Why a file is not a valid setup.

use std::fmt;

use motorlink_i18n::tr;

/// Bytes of the largest file: twice that of 254 motors with the longest names.
pub const SETUP_BYTES_MAX: usize = 65_536;

/// Why a file is not a valid setup. The text names the place and what is allowed there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SetupError {
    /// It has more than [`SETUP_BYTES_MAX`] bytes.
    TooLarge,
    /// Not valid JSON or not UTF-8 from here on.
    NoJson {
        /// From 1.
        line: usize,
        /// In characters, from 1.
        column: usize,
    },
    /// Valid JSON with an invalid value.
    At {
        /// As in `motors[2].side`, counted from 0; empty for the whole file.
        place: String,
        /// What is wrong there.
        misfit: Misfit,
    },
}

/// What is wrong at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Misfit {
    /// Another type or value was expected.
    Not(Allowed),
    /// A required field is missing.
    Missing(Allowed),
    /// An unknown field; these are known.
    Unknown(&'static [&'static str]),
    /// A duplicate field.
    Twice,
    /// An earlier motor has this ID.
    SameId,
}

/// What is allowed at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Allowed {
    /// The version of the file.
    Version,
    /// A model.
    Model,
    /// A whole number in this range.
    Whole((u16, u16)),
    /// True or false.
    Yes,
    /// The motors.
    List,
    /// The name of a motor.
    Name,
    /// The side of a motor.
    Side,
    /// What a motor does when frames cease.
    Behaviour,
    /// Fields.
    Object,
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Version => tr!("1 (the supported version)"),
            Self::Model => tr!("\"ddsm115\", \"ddsm315\", \"ddsm210\" or \"ddsm400\""),
            Self::Whole((least, most)) => {
                return f.write_str(&tr!("a whole number from {least} to {most}", least, most));
            }
            Self::Yes => tr!("true or false"),
            Self::List => tr!("a list of motors"),
            Self::Name => tr!("text of at most 16 characters, no control characters"),
            Self::Side => tr!("\"none\", \"left\" or \"right\""),
            Self::Behaviour => tr!("\"keeps\", \"coasts\" or \"brakes\""),
            Self::Object => tr!("a JSON object"),
        })
    }
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&match self {
            Self::TooLarge => {
                let kilobytes = SETUP_BYTES_MAX / 1024;
                tr!(
                    "File too large: a setup has at most {kilobytes} KB.",
                    kilobytes
                )
            }
            Self::NoJson { line, column } => tr!(
                "Invalid JSON at line {line}, column {column}.",
                line,
                column
            ),
            Self::At { place, misfit } => {
                let place = if place.is_empty() {
                    tr!("The file")
                } else {
                    place
                };
                tr!("{place}: {misfit}.", place, misfit)
            }
        })
    }
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&match self {
            Self::Not(allowed) => tr!("expected {allowed}", allowed),
            Self::Missing(allowed) => tr!("missing; expected {allowed}", allowed),
            Self::Unknown(fields) => {
                tr!(
                    "unknown field; known fields: {fields}",
                    fields = fields.join(", ")
                )
            }
            Self::Twice => tr!("duplicate field").to_owned(),
            Self::SameId => tr!("duplicate ID").to_owned(),
        })
    }
}

impl std::error::Error for SetupError {}
