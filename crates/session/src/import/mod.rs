//! Imports CSV files as sessions: our exports, the monitor script of the article, and the log of the original page.
//!
//! The import converts a CSV file to a session file, which is then opened. So there is only one reader, and all other
//! functions work.
//!
//! | first line | file |
//! |---|---|
//! | `time,elapsed_s,direction,id,hex,meaning` | our packet log |
//! | `timestamp,motor_id,...,raw_hex` | our telemetry, or the article's `motor_log.csv`, whose times have no date |
//! | `Timestamp,Type,Content` | the log of the original page, whose times have no date |
//!
//! A spreadsheet program may have saved it again, with semicolons or tabs, a line `sep=;`, or in UTF-16: the text is read as
//! that of a sequence.

mod lines;
mod rows;
mod times;

use motorlink_messages::experiments::sequence::{Decoder, separator_of};
use motorlink_protocol::Instant;

use self::{
    lines::Lines,
    rows::{Columns, Line, Rows},
    times::Clock,
};
use crate::{
    reader::{NotASession, Problem, Problems},
    writer::Writer,
};

/// The separator follows from the first two lines, which have no more bytes.
const HEAD_BYTES_MAX: usize = 1_000;

/// Converts a CSV file to a session file, piece by piece.
#[derive(Debug, Default)]
pub struct Import {
    decoder: Decoder,
    /// The text until its separator is known.
    head: Vec<u8>,
    lines: Option<Lines>,
    state: State,
    problems: Problems,
}

#[derive(Debug, Default)]
enum State {
    /// The first line is incomplete.
    #[default]
    Head,
    /// Before the first line with a time.
    Empty(Rows),
    Rows(Box<Running>),
    Unknown,
}

#[derive(Debug)]
struct Running {
    rows: Rows,
    clock: Clock,
    /// The time of the first line, in microseconds.
    first_us: i64,
    /// Whether the times have dates.
    has_date: bool,
    writer: Writer,
}

impl Import {
    /// Takes the next bytes of the CSV file.
    pub fn feed(&mut self, bytes: &[u8]) {
        self.decode(bytes, false);
    }

    fn decode(&mut self, bytes: &[u8], is_last: bool) {
        let mut text = self.decoder.decode(bytes, is_last);
        let Self {
            head,
            lines,
            state,
            problems,
            ..
        } = self;
        if lines.is_none() {
            head.extend(text);
            let has_two_lines = head.splitn(3, |byte| *byte == b'\n').count() == 3;
            if !has_two_lines && head.len() < HEAD_BYTES_MAX && !is_last {
                return;
            }
            let (separator, rest, _) = separator_of(head);
            *lines = Some(Lines::new(separator));
            text = rest.to_vec();
            *head = Vec::new();
        }
        if let Some(lines) = lines {
            lines.feed(&text, is_last, |cells| take(state, problems, cells));
        }
    }

    /// Takes the completed bytes of the session file.
    pub fn take(&mut self) -> Vec<u8> {
        match &mut self.state {
            State::Rows(running) => running.writer.take(),
            State::Head | State::Empty(_) | State::Unknown => Vec::new(),
        }
    }

    /// Whether the columns belong to no known file: more bytes change nothing.
    #[must_use]
    pub const fn is_unknown(&self) -> bool {
        matches!(self.state, State::Unknown)
    }

    /// Ends the session file. Returns its remaining bytes, and the unreadable parts of the CSV file.
    ///
    /// # Errors
    /// The columns belong to no known file.
    pub fn finish(mut self) -> Result<(Vec<u8>, Problems), NotASession> {
        self.decode(&[], true);
        match self.state {
            State::Rows(running) => Ok((running.writer.finish(), self.problems)),
            State::Empty(_) => Ok((Writer::new(0, &[]).finish(), self.problems)),
            State::Head | State::Unknown => Err(NotASession::Text),
        }
    }
}

/// Takes one line; `None` is a line that is too long.
fn take(state: &mut State, problems: &mut Problems, cells: Option<&[&str]>) {
    match state {
        State::Head => {
            let columns = cells.and_then(Columns::of_head);
            *state = columns.map_or(State::Unknown, |columns| State::Empty(Rows::new(columns)));
        }
        State::Empty(rows) => match read(rows, cells) {
            Ok(first) => {
                let has_date = first.time.has_date();
                if !has_date {
                    problems.add(Problem::NoDate);
                }
                let mut clock = Clock::default();
                let first_us = clock.unix_us(first.time);
                let mut running = Running {
                    rows: std::mem::replace(rows, Rows::new(Columns::Log)),
                    clock,
                    first_us,
                    has_date,
                    writer: Writer::new(first_us, &[("imported_from", "CSV")]),
                };
                running.take(&first);
                *state = State::Rows(Box::new(running));
            }
            Err(problem) => problems.add(problem),
        },
        State::Rows(running) => match read(&running.rows, cells) {
            // Without its date it would be in another year.
            Ok(line) if line.time.has_date() != running.has_date => problems.add(Problem::TimeLost),
            Ok(line) => running.take(&line),
            Err(problem) => problems.add(problem),
        },
        State::Unknown => {}
    }
}

fn read<'a>(rows: &Rows, cells: Option<&[&'a str]>) -> Result<Line<'a>, Problem> {
    rows.read(cells.ok_or(Problem::LineDamaged)?)
}

impl Running {
    fn take(&mut self, line: &Line<'_>) {
        let since = self.clock.unix_us(line.time).saturating_sub(self.first_us);
        let at = Instant::from_micros(u64::try_from(since).unwrap_or_default());
        self.rows.write(at, line, &mut self.writer);
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
