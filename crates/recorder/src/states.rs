//! What the page showed: its states, in order of time.

use std::collections::VecDeque;

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

/// The newest states. Each has a number, which it keeps.
#[derive(Debug, Default)]
pub(crate) struct States {
    kept: VecDeque<State>,
    bytes: usize,
    first: u64,
}

impl States {
    pub(crate) fn push(&mut self, state: State) {
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
        for state in other.kept {
            let at = at(state.at);
            self.push(State { at, ..state });
        }
    }

    /// The numbers of all.
    pub(crate) fn numbers(&self) -> std::ops::Range<u64> {
        self.first..self.first + self.kept.len() as u64
    }

    pub(crate) fn get(&self, number: u64) -> Option<&State> {
        let place = usize::try_from(number.checked_sub(self.first)?).ok()?;
        self.kept.get(place)
    }
}
