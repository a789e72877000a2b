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
    Not(&'static str),
    /// A required field is missing.
    Missing(&'static str),
    /// An unknown field; these are known.
    Unknown(&'static [&'static str]),
    /// A duplicate field.
    Twice,
    /// An earlier motor has this ID.
    SameId,
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
