//! CSV files, made a slice at a time.
//!
//! Both are what RFC 4180 describes: a head, lines that end in CR LF, quotes where they are needed.
//! They are UTF-8 without a byte order mark, which many programs take for a part of the first name in
//! the head.
//!
//! Times are ISO 8601 in UTC in both files, so that a row of telemetry is found in the log by its time,
//! a recording over midnight or over the change to summer time stays in order, and every program reads
//! the same moment from it. (The article's script writes the time of day only.)

mod cells;
mod lines;
mod log_lines;
mod telemetry_lines;

use std::ops::Range;

use motorlink_messages::recorder::Export;

pub use self::lines::CsvLines;
use self::{cells::Cells, log_lines::LogLines, telemetry_lines::TelemetryLines};
use crate::{
    log::Log,
    recording::{Recording, Which},
};

/// A file that is being made.
#[derive(Debug)]
pub struct CsvFile {
    lines: Lines,
    next: u64,
    until: u64,
    rows: u64,
    cells: Cells,
    out: Vec<u8>,
}

/// What the lines are.
#[derive(Debug)]
enum Lines {
    Log(LogLines),
    Telemetry(Which, TelemetryLines),
}

impl CsvFile {
    /// Of every entry of the log, shown or not. Entries that come later are not in it, and one that
    /// gives way before its turn is left out.
    #[must_use]
    pub fn of_log(log: &mut Log) -> Self {
        let range = log.settle();
        let first_at = log.entries().oldest().map(|entry| entry.at);
        let lines = LogLines::new(first_at.unwrap_or_default());
        Self::new(Lines::Log(lines), range, &log_lines::HEAD)
    }

    /// Of the recording, or of the last ten minutes where nothing was recorded.
    #[must_use]
    pub fn of_telemetry(recording: &Recording) -> Self {
        let (which, range) = recording.to_export();
        let lines = Lines::Telemetry(which, TelemetryLines::default());
        Self::new(lines, range, &telemetry_lines::HEAD)
    }

    fn new(lines: Lines, Range { start, end }: Range<u64>, head: &[&str]) -> Self {
        let mut cells = Cells::default();
        let mut out = Vec::new();
        for name in head {
            cells.plain(name);
        }
        cells.end_line(&mut out);
        Self {
            lines,
            next: start,
            until: end,
            rows: 0,
            cells,
            out,
        }
    }

    /// What it is a file of.
    #[must_use]
    pub const fn what(&self) -> Export {
        match self.lines {
            Lines::Log(_) => Export::Log,
            Lines::Telemetry(..) => Export::Telemetry,
        }
    }

    /// Writes so many lines more, and says whether that was all.
    pub fn advance(&mut self, log: &Log, recording: &Recording, lines: u64) -> bool {
        let clock = log.clock();
        let first = match &self.lines {
            Lines::Log(_) => log.entries().first(),
            Lines::Telemetry(which, _) => recording.samples(*which).first(),
        };
        self.next = self.next.max(first).min(self.until);
        let until = self.until.min(self.next.saturating_add(lines));
        let Self { cells, out, .. } = self;
        while self.next < until {
            match &mut self.lines {
                Lines::Log(lines) => {
                    if let Some(entry) = log.entries().get(self.next) {
                        lines.write(cells, &entry, log.texts(), clock);
                        cells.end_line(out);
                        self.rows += 1;
                    }
                }
                Lines::Telemetry(which, lines) => {
                    if let Some(sample) = recording.samples(*which).get(self.next) {
                        lines.write(cells, &sample, clock);
                        cells.end_line(out);
                        self.rows += 1;
                    }
                }
            }
            self.next += 1;
        }
        self.next >= self.until
    }

    /// Lines that are written, without the head.
    #[must_use]
    pub const fn rows(&self) -> u64 {
        self.rows
    }

    /// Lines that it will have, as far as is known.
    #[must_use]
    pub const fn rows_in_all(&self) -> u64 {
        self.rows + self.until.saturating_sub(self.next)
    }

    /// Bytes that were written and not taken.
    #[must_use]
    pub const fn written(&self) -> usize {
        self.out.len()
    }

    /// Takes the bytes that were written since the last time.
    pub fn take(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.out)
    }

    /// The recording that a file is made of up to this sample.
    pub(crate) const fn recorded_until(&self) -> Option<u64> {
        match self.lines {
            Lines::Telemetry(Which::Recorded, _) => Some(self.until),
            Lines::Telemetry(Which::Rolling, _) | Lines::Log(_) => None,
        }
    }
}
