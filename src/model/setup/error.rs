//! Why a file is no setup.

use std::fmt;

use motorlink_i18n::tr;

/// Bytes of the largest file: twice that of 254 motors with the longest names.
pub const SETUP_BYTES_MAX: usize = 65_536;

/// Why a file is no setup. Its text names the place and says what is allowed there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SetupError {
    /// It has more than [`SETUP_BYTES_MAX`] bytes.
    TooLarge,
    /// From here on it is no JSON, or no text at all.
    NoJson {
        /// From 1.
        line: usize,
        /// In characters, from 1.
        column: usize,
    },
    /// It is JSON, but something in it does not fit.
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
    /// It is something else than this.
    Not(&'static str),
    /// It must be there, as this.
    Missing(&'static str),
    /// There is no such field, only these.
    Unknown(&'static [&'static str]),
    /// It is there a second time.
    Twice,
    /// A motor before it has this ID.
    SameId,
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&match self {
            Self::TooLarge => {
                let kilobytes = SETUP_BYTES_MAX / 1024;
                tr!("A setup has at most {kilobytes} KB.", kilobytes)
            }
            Self::NoJson { line, column } => tr!(
                "Line {line}, column {column}: from here on it is no JSON.",
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
            Self::Not(allowed) => tr!("allowed is {allowed}", allowed),
            Self::Missing(allowed) => tr!("is missing; allowed is {allowed}", allowed),
            Self::Unknown(fields) => {
                tr!("unknown; there are {fields}", fields = fields.join(", "))
            }
            Self::Twice => tr!("is there twice").to_owned(),
            Self::SameId => tr!("a motor before it has this ID").to_owned(),
        })
    }
}

impl std::error::Error for SetupError {}
