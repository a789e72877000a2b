//! The exceptions. Their text is one line and says what to do.

use motorlink_command::library::Failure;
use pyo3::{PyErr, create_exception, exceptions::PyException};

create_exception!(motorlink, Error, PyException, "An error of motorlink.");
create_exception!(
    motorlink,
    NotDone,
    Error,
    "The motors or the line did not do it."
);
create_exception!(
    motorlink,
    InvalidInput,
    Error,
    "A value or a file cannot be used."
);

/// The exception of a failure.
pub fn exception(failure: &Failure) -> PyErr {
    let text = failure.to_string();
    match failure {
        Failure::NotDone(_) | Failure::OtherModel(_) => not_done(&text),
        Failure::Usage(_) => InvalidInput::new_err(text),
        Failure::Interrupted => NotDone::new_err("the line is closed"),
    }
}

/// Its class says already that it was not done.
pub fn not_done(text: &str) -> PyErr {
    NotDone::new_err(text.strip_prefix("not done: ").unwrap_or(text).to_owned())
}
