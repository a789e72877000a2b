//! Maps rows to entries of the log.
//!
//! There is no list of rows. Every entry has its visibility, and every chunk of the log ([`CHUNK`]
//! entries) the number of its rows: to find a row, at most a thousand numbers are added up. So a view
//! takes 4 kB, however many rows it has, and dropping an old entry is one subtraction.
//!
//! A new filter starts at the newest entries and proceeds to the oldest, because the user sees the newest
//! first. Rows found on the way get smaller and smaller numbers.

mod opened;
mod toggle;

use motorlink_messages::recorder::{Filter, LogPage, Row, Window};

use self::opened::Opened;
use crate::{
    chunks::{CHUNK, Chunks},
    entry::{Entry, Visibility},
    row_filter::RowFilter,
    row_words,
    stored_texts::Texts,
    wall_clock::WallClock,
};

/// How many entries a late entry may be moved back. Line events arrive up to 100 ms late, in which the line
/// carries at most 115 frames (575 exchanges a second of two frames each).
pub(crate) const REORDER_MAX: u64 = 256;

/// Entries per tally.
const CHUNK_LEN: u64 = CHUNK as u64;

/// The parts of the log that the view reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowContext<'a> {
    pub(crate) texts: &'a Texts,
    pub(crate) clock: WallClock,
}

#[derive(Debug)]
pub(crate) struct View {
    row_filter: RowFilter,
    /// One per chunk of the log, as a ring: the slot of a dropped chunk is reused.
    tallies: Vec<Tally>,
    /// Entries from this one on have been filtered.
    filtered_from: u64,
    oldest_row: u64,
    end_row: u64,
    collapsed: u64,
    opened: Opened,
    generation: u32,
}

/// Counts the entries of one chunk of the log.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    shown: u16,
    collapsed: u16,
}

impl Tally {
    const fn count(&mut self, visibility: Visibility) -> Option<&mut u16> {
        match visibility {
            Visibility::Hidden => None,
            Visibility::Collapsed => Some(&mut self.collapsed),
            Visibility::Shown => Some(&mut self.shown),
        }
    }
}

impl View {
    /// A view without a filter, for a log with room for this number of entries.
    pub(crate) fn new(capacity: u64) -> Self {
        // The oldest and the newest chunk may both be partly filled.
        let chunks = capacity.div_ceil(CHUNK_LEN) + 2;
        Self {
            row_filter: RowFilter::default(),
            tallies: vec![Tally::default(); usize::try_from(chunks).unwrap_or(usize::MAX)],
            filtered_from: 0,
            oldest_row: 0,
            end_row: 0,
            collapsed: 0,
            opened: Opened::default(),
            generation: 0,
        }
    }

    /// Restarts with another filter. The newest entries are filtered at once, because a late entry may still
    /// move them.
    pub(crate) fn filter(
        &mut self,
        filter: &Filter,
        entries: &mut Chunks<Entry>,
        context: RowContext<'_>,
    ) {
        self.row_filter = RowFilter::new(filter);
        self.begin(entries);
        self.advance(entries, context, REORDER_MAX);
    }

    /// Restarts with the same filter; no entry is filtered yet.
    pub(crate) fn begin(&mut self, entries: &Chunks<Entry>) {
        self.tallies.fill(Tally::default());
        self.filtered_from = entries.end();
        // At most this many rows are added before it, so numbers stay positive.
        self.oldest_row = entries.len();
        self.end_row = self.oldest_row;
        self.collapsed = 0;
        self.opened.clear();
        self.generation = self.generation.wrapping_add(1);
    }

    /// Continues the generation of another view.
    pub(crate) const fn continue_from(&mut self, other: &Self) {
        self.generation = other.generation;
    }

    /// Filters this number of further entries, towards the oldest. Returns whether all are filtered.
    pub(crate) fn advance(
        &mut self,
        entries: &mut Chunks<Entry>,
        context: RowContext<'_>,
        budget: u64,
    ) -> bool {
        let until = self.filtered_from.saturating_sub(budget);
        while self.filtered_from > until.max(entries.first()) {
            self.filtered_from -= 1;
            if self.classify(entries, self.filtered_from, context) == Visibility::Shown {
                self.oldest_row = self.oldest_row.saturating_sub(1);
            }
        }
        self.is_complete(entries)
    }

    pub(crate) const fn is_complete(&self, entries: &Chunks<Entry>) -> bool {
        self.filtered_from <= entries.first()
    }

    /// An entry was inserted at this number. The entries after it have moved by one.
    pub(crate) fn entry_added(
        &mut self,
        entries: &mut Chunks<Entry>,
        number: u64,
        context: RowContext<'_>,
    ) {
        self.opened.entry_added(number);
        // Fewer entries moved than a chunk has, so at most one moved to the next chunk.
        let newest = entries.end().saturating_sub(1);
        let border = newest - newest % CHUNK_LEN;
        if border > number
            && let Some(moved) = entries.get(border)
        {
            self.tally(border - 1, moved.visibility, false);
            self.tally(border, moved.visibility, true);
        }
        if self.classify(entries, number, context) == Visibility::Shown {
            self.end_row += 1;
        }
    }

    /// The oldest entry was dropped.
    pub(crate) fn oldest_dropped(&mut self, number: u64, entry: &Entry) {
        if number < self.filtered_from {
            return;
        }
        self.filtered_from = number + 1;
        let visibility = entry.visibility;
        self.tally(number, visibility, false);
        // What was never collapsed was never opened.
        let was_opened = entry.routine && visibility == Visibility::Shown;
        self.opened.oldest_dropped(number, was_opened);
        match visibility {
            Visibility::Hidden => {}
            Visibility::Collapsed => self.collapsed -= 1,
            Visibility::Shown => self.oldest_row += 1,
        }
    }

    fn classify(
        &mut self,
        entries: &mut Chunks<Entry>,
        number: u64,
        context: RowContext<'_>,
    ) -> Visibility {
        let Some(entry) = entries.get_mut(number) else {
            return Visibility::Hidden;
        };
        let visibility = self
            .row_filter
            .classify(entry, context.texts, context.clock);
        entry.visibility = visibility;
        self.tally(number, visibility, true);
        if visibility == Visibility::Collapsed {
            self.collapsed += 1;
        }
        visibility
    }

    fn tally(&mut self, number: u64, visibility: Visibility, comes: bool) {
        let place = self.place_of_tally(number);
        let tally = self.tallies.get_mut(place);
        if let Some(count) = tally.and_then(|tally| tally.count(visibility)) {
            *count = if comes { *count + 1 } else { *count - 1 };
        }
    }

    fn tally_of(&self, number: u64) -> Tally {
        let tally = self.tallies.get(self.place_of_tally(number));
        tally.copied().unwrap_or_default()
    }

    fn place_of_tally(&self, number: u64) -> usize {
        let chunk = number / CHUNK_LEN % self.tallies.len() as u64;
        usize::try_from(chunk).unwrap_or_default()
    }

    /// The rows of a window and all counts, except for the count of dropped entries.
    pub(crate) fn page(
        &self,
        entries: &Chunks<Entry>,
        context: RowContext<'_>,
        window: Window,
    ) -> LogPage {
        let looked_at = entries.end() - self.filtered_from;
        let filtered_per_mille = match entries.len() {
            0 => 1000,
            kept => u16::try_from(looked_at * 1000 / kept).unwrap_or(1000),
        };
        LogPage {
            oldest: self.oldest_row,
            end: self.end_row,
            kept: entries.len(),
            gone: 0,
            collapsed: self.collapsed,
            filtered_per_mille,
            generation: self.generation,
            rows: self.rows(entries, context, window),
        }
    }

    fn rows(&self, entries: &Chunks<Entry>, context: RowContext<'_>, window: Window) -> Vec<Row> {
        let most = u64::from(window.rows.min(Window::ROWS_MAX));
        let newest = self.end_row.saturating_sub(most);
        let wanted = window.first.unwrap_or(newest);
        let first = wanted.max(self.oldest_row);
        let until = wanted.saturating_add(most).min(self.end_row);
        let Some(start) = (first < until)
            .then(|| self.entry_of(entries, first))
            .flatten()
        else {
            return Vec::new();
        };
        let mut collapsed = self.collapsed_right_before(entries, start);
        let mut rows = Vec::with_capacity(usize::from(window.rows.min(Window::ROWS_MAX)));
        let mut number = first;
        let mut place = start;
        while number < until && place < entries.end() {
            let tally = self.tally_of(place);
            if place.is_multiple_of(CHUNK_LEN) && tally.shown == 0 {
                collapsed += u32::from(tally.collapsed);
                place += CHUNK_LEN;
                continue;
            }
            let Some(entry) = entries.get(place) else {
                break;
            };
            match entry.visibility {
                Visibility::Hidden => {}
                Visibility::Collapsed => collapsed += 1,
                Visibility::Shown => {
                    rows.push(Row {
                        number,
                        collapsed_before: std::mem::take(&mut collapsed),
                        opened: self.opened_at(entries, place),
                        ..row_words::row(&entry, context.texts, context.clock)
                    });
                    number += 1;
                }
            }
            place += 1;
        }
        rows
    }

    /// The entry of this row.
    pub(crate) fn entry_of(&self, entries: &Chunks<Entry>, row: u64) -> Option<u64> {
        let mut rows_before = row.checked_sub(self.oldest_row)?;
        let mut place = self.filtered_from;
        while place < entries.end() {
            let in_chunk = u64::from(self.tally_of(place).shown);
            let next_chunk = (place / CHUNK_LEN + 1) * CHUNK_LEN;
            if rows_before < in_chunk {
                let shown = |place: &u64| {
                    let entry = entries.get(*place);
                    entry.is_some_and(|entry| entry.visibility == Visibility::Shown)
                };
                let nth = usize::try_from(rows_before).ok()?;
                return (place..next_chunk.min(entries.end()))
                    .filter(shown)
                    .nth(nth);
            }
            rows_before -= in_chunk;
            place = next_chunk;
        }
        None
    }

    /// Number of collapsed entries between this entry and the row before it.
    fn collapsed_right_before(&self, entries: &Chunks<Entry>, place: u64) -> u32 {
        let mut collapsed = 0;
        let mut place = place;
        while place > self.filtered_from {
            let tally = self.tally_of(place - 1);
            // A chunk without a row is skipped.
            if place.is_multiple_of(CHUNK_LEN) && tally.shown == 0 {
                collapsed += u32::from(tally.collapsed);
                place -= CHUNK_LEN;
                continue;
            }
            place -= 1;
            match entries.get(place).map(|entry| entry.visibility) {
                Some(Visibility::Shown) | None => break,
                Some(Visibility::Collapsed) => collapsed += 1,
                Some(Visibility::Hidden) => {}
            }
        }
        collapsed
    }
}
