//! CSV files, written in slices.
//!
//! Both follow RFC 4180: a header, lines that end in CR LF, quotes where needed. They are UTF-8 without a
//! byte order mark, because many programs read that mark as a part of the first column name.
//!
//! Times are ISO 8601 in UTC in both files. So a row of telemetry can be found in the log by its time, and
//! a recording stays in order over midnight and over a change of the clock. (The article's script writes
//! the time of day only.)

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
    recording::{Recording, SampleSet},
};

/// A file that is being written.
#[derive(Debug)]
pub struct CsvFile {
    lines: Lines,
    next: u64,
    until: u64,
    rows: u64,
    cells: Cells,
    out: Vec<u8>,
}

/// The kind of lines.
#[derive(Debug)]
enum Lines {
    Log(LogLines),
    Telemetry(SampleSet, TelemetryLines),
}

impl CsvFile {
    /// A file of every entry of the log, visible or not. Entries added later are not in it, and an entry that
    /// is dropped before it is written is skipped.
    #[must_use]
    pub fn of_log(log: &mut Log) -> Self {
        let range = log.settle();
        let first_at = log.entries().oldest().map(|entry| entry.at);
        let lines = LogLines::new(first_at.unwrap_or_default());
        Self::new(Lines::Log(lines), range, &log_lines::HEAD)
    }

    /// A file of the recorded samples, or of the last ten minutes if none were recorded.
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

    /// The kind of the file.
    #[must_use]
    pub const fn what(&self) -> Export {
        match self.lines {
            Lines::Log(_) => Export::Log,
            Lines::Telemetry(..) => Export::Telemetry,
        }
    }

    /// Writes this number of further lines. Returns whether the file is complete.
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

    /// Lines written, without the header.
    #[must_use]
    pub const fn rows(&self) -> u64 {
        self.rows
    }

    /// Lines that it will have, as far as known.
    #[must_use]
    pub const fn rows_in_all(&self) -> u64 {
        self.rows + self.until.saturating_sub(self.next)
    }

    /// Bytes that were written and not taken yet.
    #[must_use]
    pub const fn written(&self) -> usize {
        self.out.len()
    }

    /// Takes the bytes that were written since the last time.
    pub fn take(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.out)
    }

    /// The number after the last recorded sample in the file, if it has recorded samples.
    pub(crate) const fn recorded_until(&self) -> Option<u64> {
        match self.lines {
            Lines::Telemetry(SampleSet::Recorded, _) => Some(self.until),
            Lines::Telemetry(SampleSet::Rolling, _) | Lines::Log(_) => None,
        }
    }
}
