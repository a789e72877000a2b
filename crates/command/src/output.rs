//! What goes to the terminal. A pipe that its reader has closed is no reason to leave a motor running.

use std::{
    fmt::Display,
    io::{Write, stderr, stdout},
};

use crate::failure::Failure;

/// Prints a line of data.
///
/// # Errors
/// The standard output cannot be written.
pub fn print(text: impl Display) -> Result<(), Failure> {
    writeln!(stdout().lock(), "{text}").map_err(Failure::output)
}

/// Says something to the person. Where nobody can read it, the command goes on.
pub fn say(text: impl Display) {
    let _ = writeln!(stderr().lock(), "{text}");
}
