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

/// Where rows go: to a file, or to the standard output.
pub struct Rows<'a> {
    file: Option<&'a Path>,
    out: Box<dyn Write>,
}

impl<'a> Rows<'a> {
    /// To this file, or to the standard output.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn to(file: Option<&'a Path>) -> Result<Self, Failure> {
        let out: Box<dyn Write> = match file {
            None => Box::new(stdout()),
            Some(path) => {
                if path.exists() {
                    say(format_args!(
                        "{} exists already: it is overwritten",
                        path.display()
                    ));
                }
                Box::new(File::create(path).map_err(Failure::file(path))?)
            }
        };
        Ok(Self { file, out })
    }

    /// Writes whole rows.
    ///
    /// # Errors
    /// The disk is full, or so.
    pub fn write(&mut self, rows: &[u8]) -> Result<(), Failure> {
        let written = self.out.write_all(rows).and_then(|()| self.out.flush());
        written.map_err(|error| match self.file {
            Some(path) => Failure::file(path)(error),
            None => Failure::output(error),
        })
    }
}
