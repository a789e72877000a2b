//! Records the line to a session file.

use std::{
    fs::File,
    io::{BufWriter, Write},
    path::{Path, PathBuf},
    time::{SystemTime, UNIX_EPOCH},
};

use motorlink_bus::Event;
use motorlink_driver::{Entry, words, zero_unix_us};
use motorlink_protocol::Instant;
use motorlink_session::Writer;

use crate::failure::Failure;

/// Bytes of one write.
pub const PIECE: usize = 64 << 10;

/// A session file that is being written.
pub struct Recording {
    path: PathBuf,
    out: BufWriter<File>,
    writer: Writer,
}

impl Recording {
    /// Creates the file. `now` is the time of the driver.
    ///
    /// # Errors
    /// It exists, or cannot be written.
    pub fn create(path: &Path, now: Instant) -> Result<Self, Failure> {
        let zero_us = zero_unix_us(now);
        let file = File::create_new(path).map_err(Failure::file(path))?;
        let about = [("program", concat!("motorlink ", env!("CARGO_PKG_VERSION")))];
        Ok(Self {
            path: path.to_owned(),
            out: BufWriter::new(file),
            writer: Writer::new(zero_us, &about),
        })
    }

    /// Adds an entry of the driver.
    ///
    /// # Errors
    /// The disk is full, or so.
    pub fn add(&mut self, at: Instant, entry: &Entry) -> Result<(), Failure> {
        write_entry(&mut self.writer, at, entry);
        if self.writer.written() >= PIECE {
            self.out
                .write_all(&self.writer.take())
                .map_err(Failure::file(&self.path))?;
        }
        Ok(())
    }

    /// Writes what is left, and the index.
    pub fn finish(mut self) -> Result<(), Failure> {
        let written = self.out.write_all(&self.writer.finish());
        let written = written.and_then(|()| self.out.flush());
        written.map_err(Failure::file(&self.path))
    }
}

/// Writes an entry of the driver, if it belongs into a session.
pub fn write_entry(writer: &mut Writer, at: Instant, entry: &Entry) {
    match entry {
        Entry::Event(Event::Line(line)) => writer.line(line),
        entry => {
            if let Some(event) = words::session_event(entry) {
                writer.event(at, &event);
            }
        }
    }
}

/// The wall clock now, in milliseconds since 1970.
#[must_use]
pub fn unix_ms() -> u64 {
    let unix = SystemTime::now().duration_since(UNIX_EPOCH);
    u64::try_from(unix.unwrap_or_default().as_millis()).unwrap_or_default()
}
