//! What goes to the terminal. A pipe that its reader has closed is no reason to leave a motor running.

use std::{
    fmt::Display,
    fs::File,
    io::{Write, stderr, stdout},
    path::Path,
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

/// Where rows go: to this file, or to the standard output.
///
/// # Errors
/// The file cannot be written.
pub fn rows_to(file: Option<&Path>) -> Result<Box<dyn Write>, Failure> {
    let Some(path) = file else {
        return Ok(Box::new(stdout()));
    };
    if path.exists() {
        say(format_args!(
            "{} exists already: it is overwritten",
            path.display()
        ));
    }
    let file = File::create(path).map_err(Failure::file(path))?;
    Ok(Box::new(file))
}
