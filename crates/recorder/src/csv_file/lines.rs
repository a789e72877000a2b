//! Writes the same CSV files from single events, such as those of a session file.

use motorlink_bus::LineEvent;
use motorlink_protocol::{Instant, MotorId};

use super::{
    cells::Cells,
    log_lines::{self, LogLines},
    plot_lines::PlotLines,
    telemetry_lines::{self, TelemetryLines},
};
use crate::{
    charset::Charset,
    entry::{Entry, EntryContent, Visibility},
    recording::Line,
    stored_texts::Texts,
    wall_clock::WallClock,
};

/// Writes a CSV file line by line.
#[derive(Debug)]
pub struct CsvLines {
    columns: Columns,
    cells: Cells,
    line: Line,
}

#[derive(Debug)]
enum Columns {
    /// `None` before the first line.
    Log(Option<LogLines>, Charset),
    Telemetry(TelemetryLines),
    Plot(PlotLines),
}

impl CsvLines {
    /// Every entry, in the columns of the packet log. The character set is that of its messages.
    #[must_use]
    pub fn of_log(charset: Charset) -> Self {
        Self::new(Columns::Log(None, charset))
    }

    /// Valid replies, in the columns of the article's monitor script.
    #[must_use]
    pub fn of_telemetry() -> Self {
        Self::new(Columns::Telemetry(TelemetryLines::default()))
    }

    /// Valid replies of these motors for plotting, with columns for each motor.
    #[must_use]
    pub fn of_plot(motors: impl IntoIterator<Item = MotorId>) -> Self {
        let mut lines = PlotLines::default();
        motors.into_iter().for_each(|id| lines.add_motor(id.get()));
        Self::new(Columns::Plot(lines))
    }

    fn new(columns: Columns) -> Self {
        Self {
            columns,
            cells: Cells::default(),
            line: Line::new(),
        }
    }

    /// Adds the names of the columns.
    pub fn head(&mut self, out: &mut Vec<u8>) {
        match &self.columns {
            Columns::Log(_, charset) => log_lines::push_head(&mut self.cells, out, *charset),
            Columns::Telemetry(_) => telemetry_lines::push_head(&mut self.cells, out),
            Columns::Plot(lines) => lines.push_head(&mut self.cells, out),
        }
    }

    /// Adds the row of a line event, if it has one.
    pub fn event(&mut self, out: &mut Vec<u8>, event: &LineEvent, clock: WallClock) {
        let read = self.line.add_event(event);
        match &mut self.columns {
            Columns::Log(..) if !event.kind.is_on_the_wire() => {}
            Columns::Log(..) => {
                let content = EntryContent::Line(event.kind);
                self.entry(out, event.at, content, &Texts::default(), clock);
            }
            Columns::Telemetry(lines) => {
                if let Some((sample, reply)) = read {
                    lines.write(&mut self.cells, &sample, &reply, clock);
                    self.cells.end_line(out);
                }
            }
            Columns::Plot(lines) => {
                if let Some((sample, reply)) = read {
                    lines.write(&mut self.cells, &sample, &reply);
                    self.cells.end_line(out);
                }
            }
        }
    }

    /// Adds the row of a message, which only the log has.
    pub fn add_message(
        &mut self,
        out: &mut Vec<u8>,
        at: Instant,
        error: bool,
        text: &str,
        clock: WallClock,
    ) {
        if matches!(self.columns, Columns::Log(..)) {
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
            model: self.line.model(),
            routine: false,
            visibility: Visibility::Shown,
        };
        if let Columns::Log(lines, _) = &mut self.columns {
            let lines = lines.get_or_insert_with(|| LogLines::new(at));
            lines.write(&mut self.cells, &entry, texts, clock);
            self.cells.end_line(out);
        }
    }
}
