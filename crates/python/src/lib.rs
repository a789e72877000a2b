//! The extension module of the Python package `motorlink`. `python/motorlink/__init__.py` has what a program uses.
//!
//! | module | what it is |
//! |---|---|
//! | `line` | an open line of motors, as Python calls it |
//! | `driving` | drives motors, and stops them |
//! | `shared` | the line as calls of several threads share it |
//! | `values` | the values of a program, checked |
//! | `heard` | what happened on it since the program asked last |
//! | `reading` | what a motor reports |
//! | `study` | an experiment on it |
//! | `errors` | the exceptions |

mod driving;
mod errors;
mod heard;
mod line;
mod reading;
mod shared;
mod study;
mod values;

use pyo3::prelude::*;

#[pymodule]
mod _motorlink {
    use std::ffi::OsString;

    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::{
        errors::{Error, InvalidInput, NotDone},
        line::Line,
        reading::Reading,
    };

    /// Runs the command `motorlink` with these arguments, the first of which is the name of the program. Returns its exit
    /// code.
    #[pyfunction]
    fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
        py.detach(|| motorlink_command::run(arguments))
    }
}
