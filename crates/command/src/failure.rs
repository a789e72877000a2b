//! Why a command was not done.

use std::{fmt, io, path::Path};

use motorlink_driver::OpenFailure;
use motorlink_protocol::family::Model;

/// The exit code of a command that was done.
pub const DONE: u8 = 0;
/// The exit code of [`Failure::NotDone`].
pub const NOT_DONE: u8 = 1;
/// The exit code of [`Failure::Usage`].
pub const USAGE: u8 = 2;

/// Why a command was not done. Its text is one line and says what to do.
#[derive(Debug)]
pub enum Failure {
    /// The motors or the line did not do it: exit code 1.
    NotDone(String),
    /// Motors of this model answer, for which the line was not opened: exit code 1.
    OtherModel(Model),
    /// The command line or a file cannot be used: exit code 2.
    Usage(String),
    /// The person has ended the program before it was done: exit code 1.
    Interrupted,
}

impl Failure {
    /// For `map_err`: this file cannot be written.
    pub fn file(path: &Path) -> impl Fn(io::Error) -> Self + '_ {
        move |error| Self::Usage(format!("{}: {error}", path.display()))
    }

    /// A flag whose path cannot be used.
    #[cfg(unix)]
    pub(crate) fn path(flag: &str, path: &Path, error: &io::Error) -> Self {
        let path = path.display();
        Self::Usage(match error.kind() {
            io::ErrorKind::AlreadyExists => {
                format!("{flag} {path}: exists already; remove it or choose another path")
            }
            _ => format!("{flag} {path}: {error}"),
        })
    }

    /// For `map_err`: the system refuses what was tried.
    #[cfg(unix)]
    pub fn system<E: Into<io::Error>>(doing: &'static str) -> impl FnOnce(E) -> Self {
        move |error| Self::NotDone(format!("{doing}: {}", error.into()))
    }

    /// For `map_err`: the standard output cannot be written.
    #[expect(clippy::needless_pass_by_value, reason = "as `map_err` gives it")]
    pub(crate) fn output(error: io::Error) -> Self {
        Self::NotDone(match error.kind() {
            io::ErrorKind::BrokenPipe => "the program that reads the output has ended".to_owned(),
            _ => format!("standard output: {error}"),
        })
    }

    /// Its exit code.
    pub(crate) const fn exit_code(&self) -> u8 {
        match self {
            Self::NotDone(_) | Self::OtherModel(_) | Self::Interrupted => NOT_DONE,
            Self::Usage(_) => USAGE,
        }
    }
}

impl From<OpenFailure> for Failure {
    fn from(failure: OpenFailure) -> Self {
        match failure {
            OpenFailure::Ended => Self::Interrupted,
            failure => Self::NotDone(failure.to_string()),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotDone(text) | Self::Usage(text) => f.write_str(text),
            Self::OtherModel(found) => write!(
                f,
                "a {found} answers on this line: open it with the model {}",
                found.spec().key
            ),
            Self::Interrupted => f.write_str("interrupted"),
        }
    }
}
