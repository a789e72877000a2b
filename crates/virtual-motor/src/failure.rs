//! Why the program gave up.

use std::{fmt, io, path::Path, process::ExitCode};

/// In one line, with what to do where that is known.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line cannot be obeyed: exit code 2.
    Usage(String),
    /// The machine refused something: exit code 1.
    System {
        /// What was tried.
        doing: &'static str,
        /// What the system said.
        error: io::Error,
    },
}

impl Failure {
    /// A flag whose path cannot be used.
    pub(crate) fn path(flag: &str, path: &Path, error: &io::Error) -> Self {
        let path = path.display();
        Self::Usage(match error.kind() {
            io::ErrorKind::AlreadyExists => {
                format!("{flag} {path}: exists already; remove it or choose another path")
            }
            _ => format!("{flag} {path}: {error}"),
        })
    }

    /// For `map_err`: wraps what the system said.
    pub(crate) fn system<E: Into<io::Error>>(doing: &'static str) -> impl FnOnce(E) -> Self {
        move |error| Self::System {
            doing,
            error: error.into(),
        }
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::Usage(_) => ExitCode::from(2),
            Self::System { .. } => ExitCode::FAILURE,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(text) => f.write_str(text),
            Self::System { doing, error } => write!(f, "{doing}: {error}"),
        }
    }
}
