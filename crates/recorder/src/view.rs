//! Which entries of the log are rows, and which row is which entry.
//!
//! There is no list of rows. Every entry carries its verdict, and every piece of the log
//! ([`CHUNK`] entries) the number of its rows: a row is found by adding up at most a thousand numbers.
//! So a view takes 4 kB, however many rows it has, and an old entry that gives way is one subtraction.
//!
//! A new filter begins at the newest entries and works towards the oldest, so that what a person looks
//! at is there at once. Rows found on the way get smaller and smaller numbers.

use motorlink_messages::recorder::{Filter, LogPage, Row, Window};

use crate::{
    chunks::{CHUNK, Chunks},
    entry::{Entry, Verdict},
    row_filter::RowFilter,
    texts::Texts,
    wall_clock::WallClock,
    words,
};

/// How far back a late entry may be put. Frames come up to 100 ms late, in which the line carries 115
/// frames at most (575 exchanges a second of two frames each).
pub(crate) const LOOK_BACK: u64 = 256;

/// Entries that are counted together.
const PIECE: u64 = CHUNK as u64;

/// What the view reads from the log it belongs to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowContext<'a> {
    pub(crate) texts: &'a Texts,
    pub(crate) clock: WallClock,
}

#[derive(Debug)]
pub(crate) struct View {
    row_filter: RowFilter,
    /// Of each piece of the log, by the number of the piece, which is used again when the piece is gone.
    tallies: Vec<Tally>,
    /// Entries from this one on have a verdict of this filter.
    looked_from: u64,
    oldest_row: u64,
    end_row: u64,
    collapsed: u64,
    generation: u32,
}

/// Entries of one piece of the log.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    shown: u16,
    collapsed: u16,
}

impl Tally {
    const fn count(&mut self, verdict: Verdict) -> Option<&mut u16> {
        match verdict {
            Verdict::Hidden => None,
            Verdict::Collapsed => Some(&mut self.collapsed),
            Verdict::Shown => Some(&mut self.shown),
        }
    }
}

impl View {
    /// A view of everything, for a log of so many entries.
    pub(crate) fn new(capacity: u64) -> Self {
        // The oldest and the newest piece may both be begun only.
        let pieces = capacity.div_ceil(PIECE) + 2;
        Self {
            row_filter: RowFilter::default(),
            tallies: vec![Tally::default(); usize::try_from(pieces).unwrap_or(usize::MAX)],
            looked_from: 0,
            oldest_row: 0,
            end_row: 0,
            collapsed: 0,
            generation: 0,
        }
    }

    /// Begins anew with another filter. The newest entries are looked at right away: those are the ones
    /// that may still be moved by a late one.
    pub(crate) fn filter(
        &mut self,
        filter: &Filter,
        entries: &mut Chunks<Entry>,
        context: RowContext<'_>,
    ) {
        self.row_filter = RowFilter::new(filter);
        self.begin(entries);
        self.advance(entries, context, LOOK_BACK);
    }

    /// Begins anew with the filter there is, for entries of which none was looked at.
    pub(crate) fn begin(&mut self, entries: &Chunks<Entry>) {
        self.tallies.fill(Tally::default());
        self.looked_from = entries.end();
        // Not more rows than this can be found behind it, so that numbers stay above zero.
        self.oldest_row = entries.len();
        self.end_row = self.oldest_row;
        self.collapsed = 0;
        self.generation = self.generation.wrapping_add(1);
    }

    /// Counts the changes of the filter on from those of another view.
    pub(crate) const fn go_on_as(&mut self, other: &Self) {
        self.generation = other.generation;
    }

    /// Looks at so many entries more, towards the oldest. Says whether it is through.
    pub(crate) fn advance(
        &mut self,
        entries: &mut Chunks<Entry>,
        context: RowContext<'_>,
        budget: u64,
    ) -> bool {
        let until = self.looked_from.saturating_sub(budget);
        while self.looked_from > until.max(entries.first()) {
            self.looked_from -= 1;
            if self.judge(entries, self.looked_from, context) == Verdict::Shown {
                self.oldest_row = self.oldest_row.saturating_sub(1);
            }
        }
        self.is_through(entries)
    }

    pub(crate) const fn is_through(&self, entries: &Chunks<Entry>) -> bool {
        self.looked_from <= entries.first()
    }

    /// An entry has come, which stands here. Those behind it have each moved by one.
    pub(crate) fn took(
        &mut self,
        entries: &mut Chunks<Entry>,
        number: u64,
        context: RowContext<'_>,
    ) {
        // Fewer moved than a piece holds, so at most one went into the next piece.
        let newest = entries.end().saturating_sub(1);
        let border = newest - newest % PIECE;
        if border > number
            && let Some(moved) = entries.get(border)
        {
            self.tally(border - 1, moved.verdict, false);
            self.tally(border, moved.verdict, true);
        }
        if self.judge(entries, number, context) == Verdict::Shown {
            self.end_row += 1;
        }
    }

    /// The oldest entry has given way.
    pub(crate) fn gave_way(&mut self, number: u64, verdict: Verdict) {
        if number < self.looked_from {
            return;
        }
        self.looked_from = number + 1;
        self.tally(number, verdict, false);
        match verdict {
            Verdict::Hidden => {}
            Verdict::Collapsed => self.collapsed -= 1,
            Verdict::Shown => self.oldest_row += 1,
        }
    }

    fn judge(
        &mut self,
        entries: &mut Chunks<Entry>,
        number: u64,
        context: RowContext<'_>,
    ) -> Verdict {
        let Some(entry) = entries.get_mut(number) else {
            return Verdict::Hidden;
        };
        let verdict = self.row_filter.judge(entry, context.texts, context.clock);
        entry.verdict = verdict;
        self.tally(number, verdict, true);
        if verdict == Verdict::Collapsed {
            self.collapsed += 1;
        }
        verdict
    }

    fn tally(&mut self, number: u64, verdict: Verdict, comes: bool) {
        let place = self.place_of_tally(number);
        let tally = self.tallies.get_mut(place);
        if let Some(count) = tally.and_then(|tally| tally.count(verdict)) {
            *count = if comes { *count + 1 } else { *count - 1 };
        }
    }

    fn tally_of(&self, number: u64) -> Tally {
        let tally = self.tallies.get(self.place_of_tally(number));
        tally.copied().unwrap_or_default()
    }

    fn place_of_tally(&self, number: u64) -> usize {
        let piece = number / PIECE % self.tallies.len() as u64;
        usize::try_from(piece).unwrap_or_default()
    }

    /// The rows of a window and every count, but for what the log knows itself.
    pub(crate) fn page(
        &self,
        entries: &Chunks<Entry>,
        context: RowContext<'_>,
        window: Window,
    ) -> LogPage {
        let looked_at = entries.end() - self.looked_from;
        let looked_at_per_mille = match entries.len() {
            0 => 1000,
            kept => u16::try_from(looked_at * 1000 / kept).unwrap_or(1000),
        };
        LogPage {
            oldest: self.oldest_row,
            end: self.end_row,
            kept: entries.len(),
            gone: 0,
            collapsed: self.collapsed,
            looked_at_per_mille,
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
            if place.is_multiple_of(PIECE) && tally.shown == 0 {
                collapsed += u32::from(tally.collapsed);
                place += PIECE;
                continue;
            }
            let Some(entry) = entries.get(place) else {
                break;
            };
            match entry.verdict {
                Verdict::Hidden => {}
                Verdict::Collapsed => collapsed += 1,
                Verdict::Shown => {
                    let before = std::mem::take(&mut collapsed);
                    rows.push(words::row(
                        &entry,
                        context.texts,
                        context.clock,
                        number,
                        before,
                    ));
                    number += 1;
                }
            }
            place += 1;
        }
        rows
    }

    /// The entry that is this row.
    fn entry_of(&self, entries: &Chunks<Entry>, row: u64) -> Option<u64> {
        let mut rows_before = row.checked_sub(self.oldest_row)?;
        let mut place = self.looked_from;
        while place < entries.end() {
            let in_piece = u64::from(self.tally_of(place).shown);
            let next_piece = (place / PIECE + 1) * PIECE;
            if rows_before < in_piece {
                let shown = |place: &u64| {
                    let entry = entries.get(*place);
                    entry.is_some_and(|entry| entry.verdict == Verdict::Shown)
                };
                let nth = usize::try_from(rows_before).ok()?;
                return (place..next_piece.min(entries.end()))
                    .filter(shown)
                    .nth(nth);
            }
            rows_before -= in_piece;
            place = next_piece;
        }
        None
    }

    /// How many entries were collapsed between this one and the row before it.
    fn collapsed_right_before(&self, entries: &Chunks<Entry>, place: u64) -> u32 {
        let mut collapsed = 0;
        let mut place = place;
        while place > self.looked_from {
            let tally = self.tally_of(place - 1);
            // A whole piece without a row need not be gone through.
            if place.is_multiple_of(PIECE) && tally.shown == 0 {
                collapsed += u32::from(tally.collapsed);
                place -= PIECE;
                continue;
            }
            place -= 1;
            match entries.get(place).map(|entry| entry.verdict) {
                Some(Verdict::Shown) | None => break,
                Some(Verdict::Collapsed) => collapsed += 1,
                Some(Verdict::Hidden) => {}
            }
        }
        collapsed
    }
}
