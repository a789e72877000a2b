//! The log of every frame, against which tests judge.

use std::{
    fmt::Write as _,
    fs::File,
    io::Write as _,
    path::{Path, PathBuf},
};

use motorlink_simulator::{Sender, WireFrame};

use crate::failure::Failure;

/// `<microseconds>\t<HOST|MOTOR>\t<01 64 ..>`, a line a frame.
#[derive(Debug)]
pub(crate) struct WireLog {
    file: File,
    path: PathBuf,
    lines: String,
}

impl WireLog {
    /// An empty log; an old one of this name is overwritten.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(crate) fn create(path: &Path) -> Result<Self, Failure> {
        let file = File::create(path).map_err(|error| Failure::path("--log", path, &error))?;
        Ok(Self {
            file,
            path: path.to_owned(),
            lines: String::new(),
        })
    }

    /// Writes frames out at once, so that a reader sees them when they happen.
    ///
    /// # Errors
    /// The disk is full, or so.
    pub(crate) fn write(&mut self, frames: impl Iterator<Item = WireFrame>) -> Result<(), Failure> {
        self.lines.clear();
        for WireFrame { at, from, frame } in frames {
            let from = match from {
                Sender::Host => "HOST",
                Sender::Motor(_) => "MOTOR",
            };
            // Writing to a string does not fail.
            let _ = writeln!(self.lines, "{}\t{from}\t{frame}", at.as_micros());
        }
        if self.lines.is_empty() {
            return Ok(());
        }
        let written = self.file.write_all(self.lines.as_bytes());
        written.map_err(|error| Failure::path("--log", &self.path, &error))
    }
}
