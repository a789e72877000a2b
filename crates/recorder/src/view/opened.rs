//! Collapsed entries that the user has opened. They are rows until they are closed, or the filter changes.

use std::ops::Range;

use crate::{
    chunks::Chunks,
    entry::{Entry, Visibility},
};

/// Opened runs that can be closed again. With more of them, the first that was opened stays open.
const RUNS_MAX: usize = 64;

/// The entries between two rows, of which the routine ones were opened.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) entries: Range<u64>,
    /// How many were opened.
    pub(super) count: u32,
}

/// The opened runs, in the order in which they were opened.
#[derive(Debug, Default)]
pub(super) struct Opened(pub(super) Vec<Run>);

impl Opened {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// An entry was inserted at this number. The entries after it have moved by one.
    pub(super) fn entry_added(&mut self, number: u64) {
        for Run { entries, .. } in &mut self.0 {
            entries.start += u64::from(number <= entries.start);
            entries.end += u64::from(number < entries.end);
        }
    }

    /// The oldest entry was dropped.
    pub(super) fn oldest_dropped(&mut self, number: u64, was_opened: bool) {
        for run in &mut self.0 {
            if run.entries.start == number {
                run.entries.start += 1;
                run.count = run.count.saturating_sub(u32::from(was_opened));
            }
        }
    }

    pub(super) fn add(&mut self, run: Run) {
        if self.0.len() >= RUNS_MAX {
            self.0.remove(0);
        }
        self.0.push(run);
    }

    /// The run whose first row is this entry. Hidden ones may be before it.
    pub(super) fn beginning_at(&self, entries: &Chunks<Entry>, number: u64) -> Option<usize> {
        let is_row = |before| {
            let entry = entries.get(before);
            entry.is_some_and(|entry| entry.visibility == Visibility::Shown)
        };
        self.0.iter().position(|Run { entries, .. }| {
            entries.contains(&number) && !(entries.start..number).rev().any(is_row)
        })
    }
}
