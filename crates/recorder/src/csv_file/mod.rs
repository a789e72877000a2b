//! CSV files, written in slices.
//!
//! They follow RFC 4180: a header, lines that end in CR LF, quotes where needed. They are ASCII; a log with
//! messages in another language than English is UTF-8 with a byte order mark (see `charset`).
//!
//! No cell is a formula to a spreadsheet: a text that could be one is marked (see `cells`).
//!
//! Times are ISO 8601 in UTC in the log and in telemetry. So a row of telemetry can be found in the log by
//! its time, and a recording stays in order over midnight and over a change of the clock. (The article's
//! script writes the time of day only.) Telemetry for plotting has elapsed seconds, which every program reads
//! as a number.

mod cells;
mod lines;
mod log_lines;
mod plot_lines;
mod telemetry_lines;

use std::ops::Range;

use motorlink_bus::LineSamples;
use motorlink_messages::recorder::Export;
use motorlink_protocol::Instant;

use self::{
    cells::Cells, log_lines::LogLines, plot_lines::PlotLines, telemetry_lines::TelemetryLines,
};
pub use self::{cells::unmarked, lines::CsvLines, log_lines::REPLY, telemetry_lines::mode_cell};
use crate::{
    log::Log,
    recording::{Recording, SampleSet},
};

/// A file that is being written.
#[derive(Debug)]
pub struct CsvFile {
    lines: Lines,
    /// The samples before the next one.
    before: LineSamples,
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
    Plot(SampleSet, PlotLines, Head),
}

/// The header of a file for plotting, which names every motor in it.
#[derive(Debug)]
enum Head {
    /// The motors of the samples before this number are known.
    Collecting(u64),
    Written,
}

impl CsvFile {
    /// A file of every entry of the log, visible or not. Entries added later are not in it, and an entry that
    /// is dropped before it is written is skipped.
    #[must_use]
    pub fn of_log(log: &mut Log) -> Self {
        let range = log.settle();
        let first_at = log.entries().oldest().map(|entry| entry.at);
        let lines = LogLines::new(first_at.unwrap_or_default());
        let mut file = Self::new(Lines::Log(lines), range);
        log_lines::push_head(&mut file.cells, &mut file.out, log.texts().charset());
        file
    }

    /// A file of the recorded samples, or of the last ten minutes if none were recorded.
    #[must_use]
    pub fn of_telemetry(recording: &Recording, time: &Range<Instant>) -> Self {
        let (which, range) = recording.to_export(time);
        let lines = Lines::Telemetry(which, TelemetryLines::default());
        Self::new(lines, range)
    }

    /// The same samples for plotting.
    #[must_use]
    pub fn of_plot(recording: &Recording, time: &Range<Instant>) -> Self {
        let (which, range) = recording.to_export(time);
        let head = Head::Collecting(range.start);
        Self::new(Lines::Plot(which, PlotLines::default(), head), range)
    }

    fn new(lines: Lines, Range { start, end }: Range<u64>) -> Self {
        let mut cells = Cells::default();
        let mut out = Vec::new();
        match lines {
            Lines::Telemetry(..) => telemetry_lines::push_head(&mut cells, &mut out),
            // They depend on what is in the file.
            Lines::Log(_) | Lines::Plot(..) => {}
        }
        Self {
            lines,
            before: LineSamples::default(),
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
            Lines::Plot(..) => Export::Plot,
        }
    }

    /// Writes this number of further lines. Returns whether the file is complete.
    pub fn advance(&mut self, log: &Log, recording: &Recording, lines: u64) -> bool {
        if !self.complete_head(recording, lines) {
            return false;
        }
        let clock = log.clock();
        let first = match &self.lines {
            Lines::Log(_) => log.entries().first(),
            Lines::Telemetry(which, _) | Lines::Plot(which, ..) => {
                recording.samples(*which).first()
            }
        };
        self.next = self.next.max(first).min(self.until);
        let until = self.until.min(self.next.saturating_add(lines));
        let Self {
            cells, out, before, ..
        } = self;
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
                    if let Some(sample) = recording.samples(*which).get(self.next)
                        && let Some(reply) = sample.read(before)
                    {
                        lines.write(cells, &sample, &reply, clock);
                        cells.end_line(out);
                        self.rows += 1;
                    }
                }
                Lines::Plot(which, lines, _) => {
                    if let Some(sample) = recording.samples(*which).get(self.next)
                        && let Some(reply) = sample.read(before)
                    {
                        lines.write(cells, &sample, &reply);
                        cells.end_line(out);
                        self.rows += 1;
                    }
                }
            }
            self.next += 1;
        }
        self.next >= self.until
    }

    /// Writes the header of a file for plotting, after a look at this number of further samples. Returns whether
    /// the header is written.
    fn complete_head(&mut self, recording: &Recording, samples: u64) -> bool {
        let Lines::Plot(which, lines, head) = &mut self.lines else {
            return true;
        };
        let Head::Collecting(next) = head else {
            return true;
        };
        let kept = recording.samples(*which);
        let from = (*next).max(kept.first()).min(self.until);
        *next = self.until.min(from.saturating_add(samples));
        for sample in (from..*next).filter_map(|number| kept.get(number)) {
            lines.add_motor(sample.address());
        }
        let is_complete = *next >= self.until;
        if is_complete {
            lines.push_head(&mut self.cells, &mut self.out);
            *head = Head::Written;
        }
        is_complete
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
            Lines::Telemetry(SampleSet::Recorded, _) | Lines::Plot(SampleSet::Recorded, ..) => {
                Some(self.until)
            }
            Lines::Telemetry(SampleSet::Rolling, _)
            | Lines::Plot(SampleSet::Rolling, ..)
            | Lines::Log(_) => None,
        }
    }
}
