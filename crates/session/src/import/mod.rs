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

mod lines;
mod rows;
mod times;

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

/// Converts a CSV file to a session file, piece by piece.
#[derive(Debug, Default)]
pub struct Import {
    lines: Lines,
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
    writer: Writer,
}

impl Import {
    /// Takes the next bytes of the CSV file.
    pub fn feed(&mut self, bytes: &[u8]) {
        let Self {
            lines,
            state,
            problems,
        } = self;
        lines.feed(bytes, |cells| take(state, problems, cells));
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
        let Self {
            lines,
            state,
            problems,
        } = &mut self;
        lines.end(|cells| take(state, problems, cells));
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
        State::Empty(rows) => match cells.and_then(|cells| rows.read(cells)) {
            Some(first) => {
                if !first.time.has_date() {
                    problems.add(Problem::NoDate);
                }
                let mut clock = Clock::default();
                let first_us = clock.unix_us(first.time);
                let mut running = Running {
                    rows: std::mem::replace(rows, Rows::new(Columns::Log)),
                    clock,
                    first_us,
                    writer: Writer::new(first_us, &[("imported_from", "CSV")]),
                };
                running.take(&first);
                *state = State::Rows(Box::new(running));
            }
            None => problems.add(Problem::LineDamaged),
        },
        State::Rows(running) => match cells.and_then(|cells| running.rows.read(cells)) {
            Some(line) => running.take(&line),
            None => problems.add(Problem::LineDamaged),
        },
        State::Unknown => {}
    }
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
