//! The packet log: the newest entries, in the order of their times, and a view of them.

use motorlink_bus::LineEvent;
use motorlink_messages::recorder::{Filter, LogPage, Window};
use motorlink_protocol::Instant;

use crate::{
    chunks::Chunks,
    entry::{Entry, Verdict, What},
    routine::Routine,
    texts::Texts,
    view::{LOOK_BACK, RowContext, View},
    wall_clock::WallClock,
};

/// Entries that are kept: at 1,000 frames a second the last quarter of an hour, in 24 MB.
pub const ENTRIES_MAX: u64 = 1_000_000;

/// Bytes of all that the page has said. A million lines of it would be no log of packets; a line is a
/// hundred bytes, so this is never reached.
const TEXT_BYTES_MAX: usize = 16_000_000;

/// The newest entries. The oldest give way, and are counted.
#[derive(Debug)]
pub struct Log {
    entries: Chunks<Entry>,
    texts: Texts,
    routine: Routine,
    view: View,
    clock: WallClock,
    capacity: u64,
    gone: u64,
    /// Entries before this one keep their places, because a file is being made of them.
    settled: u64,
}

impl Default for Log {
    fn default() -> Self {
        Self::with_capacity(ENTRIES_MAX)
    }
}

impl Log {
    /// An empty log that keeps so many entries.
    #[must_use]
    pub fn with_capacity(entries: u64) -> Self {
        Self {
            entries: Chunks::new(),
            texts: Texts::default(),
            routine: Routine::default(),
            view: View::new(entries),
            clock: WallClock::default(),
            capacity: entries.max(1),
            gone: 0,
            settled: 0,
        }
    }

    /// Sets the clock by which times are shown.
    pub const fn set_clock(&mut self, clock: WallClock) {
        self.clock = clock;
    }

    /// The clock by which times are shown.
    #[must_use]
    pub const fn clock(&self) -> WallClock {
        self.clock
    }

    /// Adds what has passed on the line.
    pub fn passed(&mut self, traffic: &LineEvent) {
        let routine = self.routine.is_next(&traffic.kind);
        self.take(traffic.at, What::Passed(traffic.kind), routine);
    }

    /// Adds what the page says.
    pub fn say(&mut self, at: Instant, error: bool, text: &str) {
        let text = self.texts.keep(text);
        self.take(at, What::Said { error, text }, false);
    }

    /// Puts an entry where its time belongs. What the page says is here at once, frames come in batches:
    /// either may have to stand before the other.
    fn take(&mut self, at: Instant, what: What, routine: bool) {
        while self.entries.len() >= self.capacity || self.texts.bytes() > TEXT_BYTES_MAX {
            if !self.give_way() {
                break;
            }
        }
        let entry = Entry {
            at,
            what,
            routine,
            verdict: Verdict::Hidden,
        };
        let mut place = self.entries.push(entry);
        let least = place.saturating_sub(LOOK_BACK).max(self.settled);
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
        let context = RowContext {
            texts: &self.texts,
            clock: self.clock,
        };
        self.view.took(&mut self.entries, place, context);
    }

    /// Lets the oldest entry go. There may be none.
    fn give_way(&mut self) -> bool {
        let number = self.entries.first();
        let Some(oldest) = self.entries.pop() else {
            return false;
        };
        if let What::Said { text, .. } = oldest.what {
            self.texts.forget(text);
        }
        self.view.gave_way(number, oldest.verdict);
        self.gone += 1;
        true
    }

    /// Forgets every entry, and what was routine: the next frame of each kind is shown again.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.texts = Texts::default();
        self.routine = Routine::default();
        self.view.begin(&self.entries);
        self.gone = 0;
    }

    /// Adds an entry of another log.
    pub(crate) fn copy(&mut self, other: &Self, number: u64, at: impl FnOnce(Instant) -> Instant) {
        let Some(entry) = other.entries.get(number) else {
            return;
        };
        let what = match entry.what {
            What::Said { error, text } => What::Said {
                error,
                text: self.texts.keep(other.texts.get(text)),
            },
            passed @ What::Passed(_) => passed,
        };
        self.take(at(entry.at), what, entry.routine);
    }

    /// Goes on as another log whose entries have been copied behind these: what is routine, and how often
    /// the rows were numbered anew. Then they are, once more, by this filter.
    pub(crate) fn go_on_as(&mut self, other: &mut Self, filter: &Filter) {
        std::mem::swap(&mut self.routine, &mut other.routine);
        self.view.go_on_as(&other.view);
        self.filter(filter);
    }

    /// As many entries as it keeps.
    pub(crate) const fn capacity(&self) -> u64 {
        self.capacity
    }

    /// Shows other entries. The newest are rows at once, the others by [`Log::advance`].
    pub fn filter(&mut self, filter: &Filter) {
        let context = RowContext {
            texts: &self.texts,
            clock: self.clock,
        };
        self.view.filter(filter, &mut self.entries, context);
    }

    /// Lets the filter look at so many entries more. Says whether it is through.
    pub fn advance(&mut self, entries: u64) -> bool {
        let context = RowContext {
            texts: &self.texts,
            clock: self.clock,
        };
        self.view.advance(&mut self.entries, context, entries)
    }

    /// Whether the filter has looked at every entry.
    #[must_use]
    pub const fn is_filtered(&self) -> bool {
        self.view.is_through(&self.entries)
    }

    /// Rows in words, and every count.
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

    /// Entries that memory is taken for: at most two pieces of 1,024 more than are kept at most.
    #[must_use]
    pub fn reserved(&self) -> usize {
        self.entries.reserved()
    }

    /// Every entry there is, for a file. From now on none of them changes its place, and none comes
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
