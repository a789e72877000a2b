//! Writes the same CSV files from single events, such as those of a session file.

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_protocol::{Instant, Reply};

use super::{
    cells::Cells,
    log_lines::{self, LogLines},
    telemetry_lines::{self, TelemetryLines},
};
use crate::{
    entry::{Entry, EntryContent, Visibility},
    recording::Sample,
    texts::Texts,
    wall_clock::WallClock,
};

/// Writes a CSV file line by line.
#[derive(Debug)]
pub struct CsvLines {
    columns: Columns,
    cells: Cells,
}

#[derive(Debug)]
enum Columns {
    /// `None` before the first line.
    Log(Option<LogLines>),
    Telemetry(TelemetryLines),
}

impl CsvLines {
    /// Every entry, in the columns of the packet log.
    #[must_use]
    pub fn of_log() -> Self {
        Self::new(Columns::Log(None))
    }

    /// Valid replies, in the columns of the article's monitor script.
    #[must_use]
    pub fn of_telemetry() -> Self {
        Self::new(Columns::Telemetry(TelemetryLines::default()))
    }

    fn new(columns: Columns) -> Self {
        Self {
            columns,
            cells: Cells::default(),
        }
    }

    /// Adds the names of the columns.
    pub fn head(&mut self, out: &mut Vec<u8>) {
        let names: &[&str] = match self.columns {
            Columns::Log(_) => &log_lines::HEAD,
            Columns::Telemetry(_) => &telemetry_lines::HEAD,
        };
        for name in names {
            self.cells.plain(name);
        }
        self.cells.end_line(out);
    }

    /// Adds the row of a line event, if it has one.
    pub fn event(&mut self, out: &mut Vec<u8>, event: &LineEvent, clock: WallClock) {
        match &mut self.columns {
            Columns::Log(_) => {
                let content = EntryContent::Line(event.kind);
                self.entry(out, event.at, content, &Texts::default(), clock);
            }
            Columns::Telemetry(lines) => {
                let LineEventKind::Received { frame, asked } = event.kind else {
                    return;
                };
                if Reply::decode(&frame, asked).is_err() {
                    return;
                }
                let at = event.at;
                lines.write(&mut self.cells, &Sample { at, frame, asked }, clock);
                self.cells.end_line(out);
            }
        }
    }

    /// Adds the row of a message; a telemetry file has none.
    pub fn add_message(
        &mut self,
        out: &mut Vec<u8>,
        at: Instant,
        error: bool,
        text: &str,
        clock: WallClock,
    ) {
        if matches!(self.columns, Columns::Log(_)) {
            let mut texts = Texts::default();
            let text = texts.keep(text);
            self.entry(
                out,
                at,
                EntryContent::Message { error, text },
                &texts,
                clock,
            );
        }
    }

    fn entry(
        &mut self,
        out: &mut Vec<u8>,
        at: Instant,
        content: EntryContent,
        texts: &Texts,
        clock: WallClock,
    ) {
        let entry = Entry {
            at,
            content,
            routine: false,
            visibility: Visibility::Shown,
        };
        if let Columns::Log(lines) = &mut self.columns {
            let lines = lines.get_or_insert_with(|| LogLines::new(at));
            lines.write(&mut self.cells, &entry, texts, clock);
            self.cells.end_line(out);
        }
    }
}
