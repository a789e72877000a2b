//! Records the line to a session file.

use std::{
    fs::File,
    io::{BufWriter, Write},
    path::{Path, PathBuf},
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use motorlink_bus::{Event, StopReport};
use motorlink_driver::Entry;
use motorlink_protocol::Instant;
use motorlink_session::{Event as Mark, EventKind, Writer};

use crate::{failure::Failure, words};

/// Bytes of one write.
const PIECE: usize = 64 << 10;

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
        let writer = &mut self.writer;
        match entry {
            Entry::Event(Event::Line(line)) => writer.line(line),
            Entry::Event(Event::StopEnded(report)) => writer.event(at, &stop_mark(report)),
            entry => {
                if let Some(text) = words::of_entry(entry) {
                    let kind = match entry {
                        Entry::PortLost { .. } => EventKind::Disconnected,
                        Entry::PortBack => EventKind::Connected,
                        _ => EventKind::Notice,
                    };
                    let mark = Mark {
                        kind,
                        error: false,
                        text,
                        motors: Vec::new(),
                    };
                    writer.event(at, &mark);
                }
            }
        }
        if writer.written() >= PIECE {
            self.out
                .write_all(&writer.take())
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

fn stop_mark(report: &StopReport) -> Mark {
    Mark {
        kind: EventKind::StopEnded,
        error: report.motors.iter().any(|motor| !motor.confirmed),
        text: words::of_stop(report),
        motors: report.motors.clone(),
    }
}

/// The wall clock now, in milliseconds since 1970.
#[must_use]
pub fn unix_ms() -> u64 {
    let unix = SystemTime::now().duration_since(UNIX_EPOCH);
    u64::try_from(unix.unwrap_or_default().as_millis()).unwrap_or_default()
}

/// The wall clock at [`Instant::ZERO`], in microseconds since 1970, where it is `now` now.
pub fn zero_unix_us(now: Instant) -> i64 {
    let unix = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    let zero = unix.saturating_sub(Duration::from_micros(now.as_micros()));
    i64::try_from(zero.as_micros()).unwrap_or_default()
}
