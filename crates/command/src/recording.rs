//! Records the line to a session file.

use std::{
    fs::File,
    io::{BufWriter, Write},
    path::{Path, PathBuf},
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use motorlink_bus::{Event, StopReport};
use motorlink_driver::{Ender, Entry};
use motorlink_protocol::Instant;
use motorlink_session::{Event as Mark, EventKind, Writer};

use crate::{
    arguments::Global,
    connection::{Connection, Happened},
    failure::Failure,
    watching::watch_found,
    words,
};

/// Bytes of one write.
const PIECE: usize = 64 << 10;

/// A session file that is being written.
pub struct Recording {
    path: PathBuf,
    out: BufWriter<File>,
    /// `None` before the first entry, which tells the time of its clock.
    writer: Option<Writer>,
}

impl Recording {
    /// Creates the file.
    ///
    /// # Errors
    /// It exists, or cannot be written.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        // A recording is not made twice.
        let file = File::create_new(path).map_err(Failure::file(path))?;
        Ok(Self {
            path: path.to_owned(),
            out: BufWriter::new(file),
            writer: None,
        })
    }

    /// Adds an entry of the driver.
    ///
    /// # Errors
    /// The disk is full, or so.
    pub fn add(&mut self, at: Instant, entry: &Entry) -> Result<(), Failure> {
        let writer = self.writer.get_or_insert_with(|| {
            let about = [("program", concat!("motorlink ", env!("CARGO_PKG_VERSION")))];
            Writer::new(zero_unix_us(at), &about)
        });
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
        let written = match self.writer {
            Some(writer) => self.out.write_all(&writer.finish()),
            None => Ok(()),
        };
        let written = written.and_then(|()| self.out.flush());
        written.map_err(Failure::file(&self.path))?;
        eprintln!("{}: recorded", self.path.display());
        Ok(())
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

/// The wall clock at [`Instant::ZERO`], in microseconds since 1970, where it is `now` now.
pub fn zero_unix_us(now: Instant) -> i64 {
    let unix = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    let zero = unix.saturating_sub(Duration::from_micros(now.as_micros()));
    i64::try_from(zero.as_micros()).unwrap_or_default()
}

/// Records until the time is over or Ctrl-C.
pub fn run(
    global: &Global,
    file: &Path,
    secs: Option<Duration>,
    ender: &Ender,
) -> Result<(), Failure> {
    let mut connection =
        Connection::open_with(global, ender, |options| options.tells_traffic = true)?;
    let mut recording = Recording::create(file)?;
    watch_found(&mut connection)?;
    eprintln!("recording to {}; Ctrl-C ends it", file.display());
    let begun = std::time::Instant::now();
    let result = loop {
        if secs.is_some_and(|secs| begun.elapsed() >= secs) {
            break Ok(());
        }
        match connection.next() {
            Ok(Happened::Entry(at, entry)) => recording.add(at, &entry)?,
            Ok(Happened::Nothing) => {}
            Err(Failure::Interrupted) => break Ok(()),
            Err(failure) => break Err(failure),
        }
    };
    let stopped = connection.end_with(|at, entry| recording.add(at, entry));
    recording.finish()?;
    result.and(stopped)
}
