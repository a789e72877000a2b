//! The packet log: the newest entries in order of time, and a view of them.

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_messages::recorder::{Filter, Kind, LogPage, Row, Window};
use motorlink_protocol::{Instant, family::Model};

use crate::{
    chunks::Chunks,
    entry::{Entry, EntryContent, Visibility},
    routine::Routine,
    row_words,
    states::{State, States},
    stored_texts::Texts,
    view::{REORDER_MAX, RowContext, View},
    wall_clock::WallClock,
};

/// Number of entries: a quarter of an hour at 1,000 frames a second, in 24 MB.
pub const ENTRIES_MAX: u64 = 1_000_000;

/// Bytes of all messages. A message has about a hundred bytes, and few entries are messages, so this is
/// never reached.
const TEXT_BYTES_MAX: usize = 16_000_000;

/// The newest entries. A full log drops the oldest, and counts them.
#[derive(Debug)]
pub struct Log {
    entries: Chunks<Entry>,
    texts: Texts,
    routine: Routine,
    states: States,
    view: View,
    clock: WallClock,
    /// The model of the line.
    model: Model,
    capacity: u64,
    gone: u64,
    /// Entries before this one keep their numbers, because they are being exported or copied.
    settled: u64,
    /// The log before it was cleared, while that can be undone.
    cleared: Option<Box<Self>>,
}

impl Default for Log {
    fn default() -> Self {
        Self::with_capacity(ENTRIES_MAX)
    }
}

impl Log {
    /// An empty log with room for this number of entries.
    #[must_use]
    pub fn with_capacity(entries: u64) -> Self {
        Self {
            entries: Chunks::new(),
            texts: Texts::default(),
            routine: Routine::default(),
            states: States::default(),
            view: View::new(entries),
            clock: WallClock::default(),
            model: Model::default(),
            capacity: entries.max(1),
            gone: 0,
            settled: 0,
            cleared: None,
        }
    }

    /// Sets the clock for the times of rows.
    pub const fn set_clock(&mut self, clock: WallClock) {
        self.clock = clock;
    }

    /// The clock for the times of rows.
    #[must_use]
    pub const fn clock(&self) -> WallClock {
        self.clock
    }

    /// Adds a line event.
    pub fn add_event(&mut self, traffic: &LineEvent) {
        if let LineEventKind::ModelSelected(model) = traffic.kind {
            self.model = model;
        }
        if !traffic.kind.is_on_the_wire() {
            return;
        }
        let routine = self.routine.is_next(self.model, &traffic.kind);
        let content = EntryContent::Line(traffic.kind);
        self.take(traffic.at, content, self.model, routine);
    }

    /// Adds a message of the page.
    pub fn add_message(&mut self, at: Instant, error: bool, text: &str) {
        let text = self.texts.keep(text);
        let content = EntryContent::Message { error, text };
        self.take(at, content, self.model, false);
    }

    /// Adds a state of the page. It is no entry, and goes with the entries of its time.
    pub(crate) fn add_state(&mut self, state: State) {
        self.states.push(state);
    }

    pub(crate) const fn states(&self) -> &States {
        &self.states
    }

    /// Inserts an entry in order of time. Messages arrive at once, line events in batches, so either may be
    /// late.
    fn take(&mut self, at: Instant, content: EntryContent, model: Model, routine: bool) {
        while self.entries.len() >= self.capacity || self.texts.bytes() > TEXT_BYTES_MAX {
            if !self.drop_oldest() {
                break;
            }
        }
        let entry = Entry {
            at,
            content,
            model,
            routine,
            visibility: Visibility::Hidden,
        };
        let mut place = self.entries.push(entry);
        let least = place.saturating_sub(REORDER_MAX).max(self.settled);
        while place > least
            && let Some(before) = self.entries.get(place - 1)
            && before.at > at
            && let Some(slot) = self.entries.get_mut(place)
        {
            *slot = before;
            place -= 1;
            if let Some(slot) = self.entries.get_mut(place) {
                *slot = entry;
            }
        }
        let row_context = RowContext {
            texts: &self.texts,
            clock: self.clock,
        };
        self.view.entry_added(&mut self.entries, place, row_context);
    }

    /// Drops the oldest entry. Returns false if there is none.
    fn drop_oldest(&mut self) -> bool {
        let number = self.entries.first();
        let Some(oldest) = self.entries.pop() else {
            return false;
        };
        if let EntryContent::Message { text, .. } = oldest.content {
            self.texts.forget(text);
        }
        self.view.oldest_dropped(number, &oldest);
        self.states.drop_before(oldest.at);
        self.gone += 1;
        true
    }

    /// Removes every entry and the state of the routine filter, so that the next frame of each kind is shown. The
    /// entries are kept aside until [`Log::forget_cleared`].
    pub fn clear(&mut self) {
        let mut new = Self::with_capacity(self.capacity);
        new.clock = self.clock;
        new.model = self.model;
        new.states.lines = self.states.lines.clone();
        new.entries = self.entries.continued();
        std::mem::swap(&mut new.view, &mut self.view);
        new.view.begin(&new.entries);
        self.view.begin(&self.entries);
        self.cleared = None;
        let before = std::mem::replace(self, new);
        self.cleared = Some(Box::new(before));
    }

    /// Restores the entries before [`Log::clear`], followed by those since, under this filter. Returns whether they were
    /// there.
    pub fn undo_clear(&mut self, filter: &Filter) -> bool {
        let Some(mut before) = self.cleared.take() else {
            return false;
        };
        // An entry that comes late moves the newest of these: the view counts only those that it has filtered.
        before.advance(REORDER_MAX);
        for number in self.settle() {
            before.copy(self, number, |at| at);
        }
        before.continue_from(self, filter, |at| at);
        *self = *before;
        true
    }

    /// Frees the entries before [`Log::clear`].
    pub fn forget_cleared(&mut self) {
        self.cleared = None;
    }

    /// Adds an entry of another log.
    pub(crate) fn copy(&mut self, other: &Self, number: u64, at: impl FnOnce(Instant) -> Instant) {
        let Some(entry) = other.entries.get(number) else {
            return;
        };
        let content = match entry.content {
            EntryContent::Message { error, text } => EntryContent::Message {
                error,
                text: self.texts.keep(other.texts.get(text)),
            },
            passed @ EntryContent::Line(_) => passed,
        };
        self.take(at(entry.at), content, entry.model, entry.routine);
    }

    /// Takes over what else another log has whose entries have been appended to this one: the states of the page, the
    /// model, what is routine, and the generation of the rows. Then applies this filter.
    pub(crate) fn continue_from(
        &mut self,
        other: &mut Self,
        filter: &Filter,
        at: impl FnMut(Instant) -> Instant,
    ) {
        self.states.append(std::mem::take(&mut other.states), at);
        self.model = other.model;
        std::mem::swap(&mut self.routine, &mut other.routine);
        self.view.continue_from(&other.view);
        self.filter(filter);
    }

    /// The maximal number of entries.
    pub(crate) const fn capacity(&self) -> u64 {
        self.capacity
    }

    /// Sets the filter. The newest entries are filtered at once, the others by [`Log::advance`].
    pub fn filter(&mut self, filter: &Filter) {
        let context = RowContext {
            texts: &self.texts,
            clock: self.clock,
        };
        self.view.filter(filter, &mut self.entries, context);
    }

    /// Filters this number of further entries. Returns whether all are filtered.
    pub fn advance(&mut self, entries: u64) -> bool {
        let context = RowContext {
            texts: &self.texts,
            clock: self.clock,
        };
        self.view.advance(&mut self.entries, context, entries)
    }

    /// Shows the collapsed entries right before this row, or collapses those that begin with it.
    pub fn toggle(&mut self, row: u64) {
        self.view.toggle(&mut self.entries, row);
    }

    /// Whether all entries have been filtered.
    #[must_use]
    pub const fn is_filtered(&self) -> bool {
        self.view.is_complete(&self.entries)
    }

    /// The rows of a window, and all counts.
    #[must_use]
    pub fn page(&self, window: Window) -> LogPage {
        let context = RowContext {
            texts: &self.texts,
            clock: self.clock,
        };
        LogPage {
            gone: self.gone,
            ..self.view.page(&self.entries, context, window)
        }
    }

    /// The newest frame as a row, whether the view shows it or not.
    #[must_use]
    pub fn newest_frame(&self) -> Option<Row> {
        let numbers = self.entries.first()..self.entries.end();
        let mut newest_first = numbers.rev().filter_map(|number| self.entries.get(number));
        let frame = newest_first.find(|entry| matches!(entry.kind(), Kind::Tx | Kind::Rx))?;
        Some(row_words::row(&frame, &self.texts, self.clock))
    }

    /// The time of a row; `None` if there is no such row.
    #[must_use]
    pub fn time_of_row(&self, row: u64) -> Option<Instant> {
        let number = self.view.entry_of(&self.entries, row)?;
        self.entries.get(number).map(|entry| entry.at)
    }

    /// Puts this log in the place of another, under this filter. The rows of `before` are of an older generation.
    pub fn replace(&mut self, before: &Self, filter: &Filter) {
        self.view.continue_from(&before.view);
        self.filter(filter);
    }

    /// Entries that memory is allocated for: at most two chunks of 1,024 more than the capacity.
    #[must_use]
    pub fn reserved(&self) -> usize {
        self.entries.reserved()
    }

    /// The numbers of all current entries. From now on none of them changes, and no late entry is inserted
    /// between them.
    pub(crate) const fn settle(&mut self) -> std::ops::Range<u64> {
        self.settled = self.entries.end();
        self.entries.first()..self.settled
    }

    pub(crate) const fn entries(&self) -> &Chunks<Entry> {
        &self.entries
    }

    pub(crate) const fn texts(&self) -> &Texts {
        &self.texts
    }
}
