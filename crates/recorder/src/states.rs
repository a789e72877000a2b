//! What the page showed: its states, in order of time.

use std::{collections::VecDeque, ops::Range};

use motorlink_messages::{Adapter, Connection, stored_state};
use motorlink_protocol::Instant;

/// A quarter of an hour has 18,000 states of 400 bytes with one motor, and of 1,200 with four.
const BYTES_MAX: usize = 24 << 20;

/// A state from its time on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct State {
    pub(crate) at: Instant,
    /// See `motorlink_messages::stored_state`.
    pub(crate) stored: Vec<u8>,
}

/// The last line, the one before it, and one more, whose end is where that one begins.
const LINES_MAX: usize = 3;

/// The lines, in order of time: a line is all that one adapter, or one set of virtual motors, has carried until another
/// was connected. Two adapters of one make are alike.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lines {
    began: Vec<(Instant, Adapter)>,
    /// When the last one was closed. What follows belongs to the next.
    closed: Option<Instant>,
}

impl Lines {
    fn note(&mut self, at: Instant, connection: Connection) {
        match connection {
            Connection::Connected(adapter) => {
                let began = self.closed.take().unwrap_or(at);
                self.begin(began, adapter);
            }
            Connection::Reconnecting(_) => {}
            Connection::Disconnected | Connection::Connecting | Connection::Failed(_) => {
                self.closed.get_or_insert(at);
            }
        }
    }

    fn begin(&mut self, at: Instant, adapter: Adapter) {
        let last = self.began.last();
        if last.is_none_or(|(began, last)| *last != adapter && *began < at) {
            self.began.push((at, adapter));
        }
        if self.began.len() > LINES_MAX {
            self.began.remove(0);
        }
    }

    /// The time of the last line, or of the one before it.
    pub(crate) fn span(&self, is_before: bool) -> Range<Instant> {
        // What came before the first one was open belongs to it.
        let began = self.began.iter().map(|(at, _)| *at).skip(1);
        let mut ends = began.rev().chain([Instant::ZERO]);
        let last = ends.next().unwrap_or_default();
        if is_before {
            ends.next().unwrap_or_default()..last
        } else {
            last..Instant::from_micros(u64::MAX)
        }
    }
}

/// The newest states. Each has a number, which it keeps.
#[derive(Debug, Default)]
pub(crate) struct States {
    pub(crate) lines: Lines,
    kept: VecDeque<State>,
    bytes: usize,
    first: u64,
}

impl States {
    pub(crate) fn push(&mut self, state: State) {
        if let Some(connection) = stored_state::connection(&state.stored) {
            self.lines.note(state.at, connection);
        }
        self.bytes += state.stored.len();
        self.kept.push_back(state);
        while self.bytes > BYTES_MAX {
            self.drop_oldest();
        }
    }

    fn drop_oldest(&mut self) {
        if let Some(oldest) = self.kept.pop_front() {
            self.bytes -= oldest.stored.len();
            self.first += 1;
        }
    }

    /// Drops the states that another has replaced by this time.
    pub(crate) fn drop_before(&mut self, at: Instant) {
        while self.kept.get(1).is_some_and(|next| next.at <= at) {
            self.drop_oldest();
        }
    }

    /// Adds those of another, which are later.
    pub(crate) fn append(&mut self, other: Self, mut at: impl FnMut(Instant) -> Instant) {
        for (began, adapter) in other.lines.began {
            self.lines.begin(at(began), adapter);
        }
        for state in other.kept {
            let at = at(state.at);
            self.push(State { at, ..state });
        }
    }

    /// The numbers of all.
    pub(crate) fn numbers(&self) -> Range<u64> {
        self.first..self.first + self.kept.len() as u64
    }

    pub(crate) fn get(&self, number: u64) -> Option<&State> {
        let place = usize::try_from(number.checked_sub(self.first)?).ok()?;
        self.kept.get(place)
    }
}
