//! Opens and closes collapsed entries of a view.

use super::{View, opened::Run};
use crate::{
    chunks::Chunks,
    entry::{Entry, Visibility},
};

impl View {
    /// How many opened entries begin with this one; 0 within a run and outside.
    pub(super) fn opened_at(&self, entries: &Chunks<Entry>, number: u64) -> u32 {
        let run = self.opened.beginning_at(entries, number);
        let run = run.and_then(|run| self.opened.0.get(run));
        run.map_or(0, |run| run.count)
    }

    /// Closes the opened entries that begin with this row. If there are none, opens the collapsed ones right before it;
    /// the row moves behind them. Rows before it keep their numbers.
    pub(crate) fn toggle(&mut self, entries: &mut Chunks<Entry>, row: u64) {
        let Some(place) = self.entry_of(entries, row) else {
            return;
        };
        if let Some(run) = self.opened.beginning_at(entries, place) {
            for number in self.opened.0.remove(run).entries {
                self.turn(entries, number, Visibility::Collapsed);
            }
            return;
        }
        let mut first = place;
        for number in (self.filtered_from..place).rev() {
            match entries.get(number).map(|entry| entry.visibility) {
                Some(Visibility::Collapsed) => first = number,
                Some(Visibility::Hidden) => {}
                Some(Visibility::Shown) | None => break,
            }
        }
        let opened = (first..place).filter(|number| self.turn(entries, *number, Visibility::Shown));
        // The log has fewer entries than a u32 counts.
        let count = u32::try_from(opened.count()).unwrap_or(u32::MAX);
        if count > 0 {
            let entries = first..place;
            self.opened.add(Run { entries, count });
        }
    }

    /// Shows or collapses an entry, if it is routine and not hidden. Returns whether it did.
    fn turn(&mut self, entries: &mut Chunks<Entry>, number: u64, to: Visibility) -> bool {
        let Some(entry) = entries.get_mut(number) else {
            return false;
        };
        let from = entry.visibility;
        if !entry.routine || from == Visibility::Hidden || from == to {
            return false;
        }
        entry.visibility = to;
        self.tally(number, from, false);
        self.tally(number, to, true);
        if to == Visibility::Shown {
            self.end_row += 1;
            self.collapsed -= 1;
        } else {
            self.end_row -= 1;
            self.collapsed += 1;
        }
        true
    }
}
