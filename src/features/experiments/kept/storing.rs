//! Reads and writes the kept runs in the browser's database.

use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use motorlink_kept_runs::{BYTES_MAX, RUNS_MAX, too_many};
use motorlink_messages::{
    encode,
    experiments::kept::{Outcome, RunHeader},
};

use super::runs::{KeptRuns, RECORDS_MAX};
use crate::ui::clock::page_now_ms;

impl KeptRuns {
    pub(super) fn load(self, number: u32) {
        let Some(database) = self.database() else {
            return;
        };
        let header = self.list.with_untracked(|list| {
            let run = list.iter().find(|run| run.number == number);
            run.cloned()
        });
        let Some(header) = header else {
            return;
        };
        spawn_local(async move {
            let Ok((record, is_whole)) = database.record(&header).await else {
                let words = tr!("The data of this run cannot be read.");
                return self.said.set(words.to_owned());
            };
            self.memory.update_value(|memory| {
                memory.incomplete.retain(|known| *known != number);
                if !is_whole {
                    memory.incomplete.push(number);
                }
                let records = &mut memory.records;
                if records.len() >= RECORDS_MAX {
                    let running = self.list.with_untracked(|list| {
                        let mut running = list.iter().filter(|run| run.outcome == Outcome::Running);
                        running.next().map(|run| run.number)
                    });
                    // The others are loaded again when they are shown.
                    records.retain(|number, _| Some(*number) == running);
                }
                records.insert(number, record);
            });
            self.changed();
        });
    }

    /// Stores what is pending.
    pub(super) fn store(self, number: u32) {
        let Some(database) = self.database() else {
            return;
        };
        let mut taken = None;
        self.memory.update_value(|memory| {
            let pending = &mut memory.pending;
            pending.stored_ms = page_now_ms();
            let part = std::mem::take(&mut pending.part);
            taken = Some((pending.place, part));
            pending.place += 1;
        });
        let Some((place, part)) = taken else {
            return;
        };
        let Ok(part) = encode(&part) else {
            return self.say_not_stored();
        };
        spawn_local(async move {
            if database.add_part(number, place, &part).await.is_err() {
                self.say_not_stored();
            }
            // Stored with each part: the page may be closed before the run ends. A part that is not stored counts too:
            // it is missing then.
            let bytes = u32::try_from(part.len()).unwrap_or(u32::MAX);
            self.change(number, |run| run.bytes = run.bytes.saturating_add(bytes));
        });
    }

    pub(super) fn change(self, number: u32, change: impl FnOnce(&mut RunHeader)) {
        let mut changed = None;
        self.memory.update_value(|memory| {
            if !memory.own.contains(&number) {
                memory.own.push(number);
            }
        });
        self.list.update(|list| {
            if let Some(run) = list.iter_mut().find(|run| run.number == number) {
                change(run);
                changed = Some(run.clone());
            }
        });
        if let Some(header) = changed {
            self.put(header);
        }
    }

    pub(super) fn put(self, header: RunHeader) {
        let Some(database) = self.database() else {
            return;
        };
        spawn_local(async move {
            if database.put_header(&header).await.is_err() {
                self.say_not_stored();
            }
        });
    }

    pub(super) fn keep_within_bounds(self) {
        let gone = self.list.with_untracked(|list| too_many(list));
        if gone.is_empty() {
            return;
        }
        self.delete(&gone);
        self.said.set(tr!(
            "The oldest runs were deleted: at most {runs} runs and {size} MB are kept.",
            runs = RUNS_MAX,
            size = BYTES_MAX / 1_000_000
        ));
    }
}
