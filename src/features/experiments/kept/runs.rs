//! The handle of the kept runs.

use std::{collections::BTreeMap, rc::Rc};

use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use motorlink_kept_runs::{Database, Headers};
use motorlink_messages::experiments::{
    kept::{Outcome, RunHeader},
    runner::{End, Record, RecordPart},
    study::{Findings, Study},
};
use motorlink_messages::protocol::{Instant, MotorId};

use crate::ui::clock::page_now_ms;

/// Parts are stored this often: a crash loses as much of a run.
const STORE_EVERY_MS: f64 = 1_000.0;
/// Figures of a run that goes on are computed this often. Those of a long record take tens of milliseconds.
const SHOW_EVERY_MS: f64 = 1_000.0;
const SHOW_LONG_EVERY_MS: f64 = 10_000.0;
/// A record with more samples is long: four minutes at 200 Hz.
const LONG: usize = 50_000;
/// Records of stored runs in memory: as many as are compared, and the one that runs.
pub(super) const RECORDS_MAX: usize = 9;

/// A run that begins.
pub(crate) struct NewRun {
    /// Of [`KeptRuns::next_number`].
    pub(crate) number: u32,
    pub(crate) study: Study,
    pub(crate) name: String,
    /// The motors with their names.
    pub(crate) motors: Vec<(MotorId, String)>,
    pub(crate) model: String,
    /// The setup of the page as JSON.
    pub(crate) setup: String,
    /// Setpoints per second to each motor.
    pub(crate) request_hz: f64,
    /// When it was started: in milliseconds since 1970, and on the clock of the worker.
    pub(crate) began_unix_ms: f64,
    pub(crate) began: Instant,
}

/// What is not stored yet of the run that goes on.
#[derive(Default)]
pub(super) struct Pending {
    pub(super) part: RecordPart,
    pub(super) place: u32,
    pub(super) stored_ms: f64,
    shown_ms: f64,
}

/// Findings with the version of the record that they follow from.
type Cache = BTreeMap<u32, (u32, Rc<Findings>)>;

/// What no view reads directly. One value, so that the handle is small.
#[derive(Default)]
pub(super) struct Memory {
    pub(super) records: BTreeMap<u32, Record>,
    pub(super) pending: Pending,
    database: Option<Rc<Database>>,
    findings: Cache,
    /// The numbers of the runs that are being deleted.
    deleting: Vec<u32>,
    /// The numbers of the runs that this page has begun or changed: it knows more of them than the database.
    pub(super) own: Vec<u32>,
    /// The numbers of the loaded runs that lack data.
    pub(super) incomplete: Vec<u32>,
}

/// The kept runs. Without storage they are kept in memory, and the user is told.
#[derive(Clone, Copy)]
pub(crate) struct KeptRuns {
    /// The headers, newest first.
    pub(crate) list: RwSignal<Vec<RunHeader>>,
    /// What the user is told, such as that old runs were deleted.
    pub(crate) said: RwSignal<String>,
    /// Grows whenever a record is loaded, extended or ended.
    pub(crate) version: RwSignal<u32>,
    pub(super) memory: StoredValue<Memory, LocalStorage>,
}

impl KeptRuns {
    /// Of this page: made at the first call, for the owner of the page.
    pub(crate) fn of_page(owner: &Owner) -> Self {
        owner.with(|| {
            use_context().unwrap_or_else(|| {
                let new = Self {
                    list: RwSignal::new(Vec::new()),
                    said: RwSignal::new(String::new()),
                    version: RwSignal::new(0),
                    memory: StoredValue::new_local(Memory::default()),
                };
                provide_context(new);
                spawn_local(new.open());
                new
            })
        })
    }

    pub(super) fn database(self) -> Option<Rc<Database>> {
        self.memory.with_value(|memory| memory.database.clone())
    }

    async fn open(self) {
        let opened = match Database::open(move || self.forget_all()).await {
            Ok(database) => database.headers().await.map(|headers| (database, headers)),
            Err(error) => Err(error),
        };
        let Ok((database, headers)) = opened else {
            return self.say_not_stored();
        };
        if headers.unread > 0 {
            self.said.set(tr!(
                "Runs of another version, which this one cannot read: {unread}.",
                unread = headers.unread
            ));
        }
        self.memory
            .update_value(|memory| memory.database = Some(Rc::new(database)));
        self.take_headers(headers);
        // A run that began before the database was open.
        let begun = self.list.with_untracked(|list| {
            let mut running = list.iter().filter(|run| run.outcome == Outcome::Running);
            running.next().cloned()
        });
        if let Some(header) = begun {
            self.put(header);
        }
    }

    /// Adds what was stored meanwhile: by the session worker, of an open file, or by another tab.
    pub(crate) fn read_again(self) {
        let Some(database) = self.database() else {
            return;
        };
        spawn_local(async move {
            let headers = database.headers().await;
            // All data may have been deleted meanwhile.
            let is_open = self
                .database()
                .is_some_and(|now| Rc::ptr_eq(&now, &database));
            if let (true, Ok(headers)) = (is_open, headers) {
                self.take_headers(headers);
            }
        });
    }

    /// Adds these runs to the list, in place of what it had of them.
    fn take_headers(self, headers: Headers) {
        let mut new = headers.read;
        self.memory.with_value(|memory| {
            new.retain(|run| {
                let number = run.number;
                !memory.deleting.contains(&number) && !memory.own.contains(&number)
            });
        });
        for run in &mut new {
            // A run without an end was cut off with its page, or another tab runs it.
            if run.outcome == Outcome::Running {
                run.outcome = Outcome::PageClosed;
            }
        }
        self.list.with_untracked(|list| {
            new.retain(|run| {
                let known = list.iter().find(|known| known.number == run.number);
                known.is_none_or(|known| {
                    (known.bytes, known.outcome) != (run.bytes, run.outcome)
                        || known.name != run.name
                })
            });
        });
        if new.is_empty() {
            return;
        }
        let numbers: Vec<u32> = new.iter().map(|run| run.number).collect();
        self.memory.update_value(|memory| {
            memory.records.retain(|number, _| !numbers.contains(number));
            memory
                .findings
                .retain(|number, _| !numbers.contains(number));
        });
        self.list.update(|list| {
            list.retain(|run| !numbers.contains(&run.number));
            for run in new {
                let place = list.partition_point(|other| other.number > run.number);
                list.insert(place, run);
            }
        });
        self.changed();
    }

    /// The user has deleted all data.
    fn forget_all(self) {
        self.memory
            .update_value(|memory| *memory = Memory::default());
        self.list.set(Vec::new());
        self.changed();
        // The next run is kept again. The browser opens the new database when the old one is deleted.
        spawn_local(self.open());
    }

    pub(super) fn say_not_stored(self) {
        let words = tr!("This browser stores no runs now. They stay until the page is closed.");
        self.said.set(words.to_owned());
    }

    /// A number that no kept run has: the seconds since 1970.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "seconds since 1970 fit until 2106"
    )]
    pub(crate) fn next_number(self) -> u32 {
        let now = (js_sys::Date::now() / 1_000.0) as u32;
        let newest = self
            .list
            .with_untracked(|list| list.first().map(|run| run.number));
        newest.map_or(now, |newest| now.max(newest.saturating_add(1)))
    }

    /// A run was started.
    pub(crate) fn begin(self, new: NewRun) {
        let header = RunHeader {
            number: new.number,
            name: new.name,
            study: new.study.to_json(),
            motors: new.motors,
            model: new.model,
            setup: new.setup,
            page_version: env!("CARGO_PKG_VERSION").to_owned(),
            began_unix_ms: new.began_unix_ms,
            began: Some(new.began),
            request_hz: new.request_hz,
            outcome: Outcome::Running,
            bytes: 0,
        };
        let record = header.record();
        self.memory.update_value(|memory| {
            let records = &mut memory.records;
            records.insert(header.number, record);
            memory.own.push(header.number);
            memory.pending = Pending::default();
        });
        self.list.update(|list| list.insert(0, header.clone()));
        self.put(header);
        self.keep_within_bounds();
        self.changed();
    }

    /// Adds a part to the record of the run that goes on. It is stored about once a second.
    pub(crate) fn add_part(self, number: u32, part: RecordPart) {
        let mut samples = 0;
        self.memory.update_value(|memory| {
            let records = &mut memory.records;
            if let Some(record) = records.get_mut(&number) {
                record.add_part(part.clone());
                samples = record.samples().len();
            }
        });
        let now_ms = page_now_ms();
        let mut is_shown = false;
        let mut is_due = false;
        self.memory.update_value(|memory| {
            let pending = &mut memory.pending;
            pending.part.samples.extend(part.samples);
            pending.part.sent.extend(part.sent);
            pending.part.marks.extend(part.marks);
            is_due = now_ms - pending.stored_ms >= STORE_EVERY_MS;
            let every_ms = if samples > LONG {
                SHOW_LONG_EVERY_MS
            } else {
                SHOW_EVERY_MS
            };
            is_shown = now_ms - pending.shown_ms >= every_ms;
            if is_shown {
                pending.shown_ms = now_ms;
            }
        });
        if is_due {
            self.store(number);
        }
        if is_shown {
            self.changed();
        }
    }

    /// The run has ended.
    pub(crate) fn end(self, number: u32, end: End) {
        self.memory.update_value(|memory| {
            let records = &mut memory.records;
            if let Some(record) = records.get_mut(&number) {
                record.ended(end);
            }
        });
        self.store(number);
        self.change(number, |run| run.outcome = Outcome::Ended(end));
        self.changed();
    }

    /// Gives a run another name.
    pub(crate) fn rename(self, number: u32, name: &str) {
        self.change(number, |run| name.clone_into(&mut run.name));
    }

    /// Deletes runs, except one that goes on.
    pub(crate) fn delete(self, numbers: &[u32]) {
        let goes =
            |run: &RunHeader| numbers.contains(&run.number) && run.outcome != Outcome::Running;
        let gone: Vec<u32> = self.list.with_untracked(|list| {
            let gone = list.iter().filter(|run| goes(run));
            gone.map(|run| run.number).collect()
        });
        self.list
            .update(|list| list.retain(|run| !gone.contains(&run.number)));
        self.memory.update_value(|memory| {
            let records = &mut memory.records;
            records.retain(|number, _| !gone.contains(number));
        });
        self.memory
            .update_value(|memory| memory.findings.retain(|number, _| !gone.contains(number)));
        let Some(database) = self.database() else {
            return;
        };
        self.memory
            .update_value(|memory| memory.deleting.extend(&gone));
        spawn_local(async move {
            for number in gone {
                if database.delete(number).await.is_err() {
                    self.say_not_stored();
                }
                self.memory.update_value(|memory| {
                    memory.deleting.retain(|deleted| *deleted != number);
                    // A file may bring it back.
                    memory.own.retain(|own| *own != number);
                });
            }
        });
    }

    /// The header of a run. It is tracked.
    pub(crate) fn header(self, number: u32) -> Option<RunHeader> {
        self.list
            .with(|list| list.iter().find(|run| run.number == number).cloned())
    }

    /// The record of a run, if it is in memory; else it is loaded, and `version` grows.
    pub(crate) fn with_record<T>(self, number: u32, read: impl FnOnce(&Record) -> T) -> Option<T> {
        self.version.track();
        let found = self
            .memory
            .with_value(|memory| memory.records.get(&number).map(read));
        if found.is_none() {
            self.load(number);
        }
        found
    }

    /// Whether the record of this run was loaded and lacks data.
    pub(crate) fn is_incomplete(self, number: u32) -> bool {
        self.version.track();
        self.memory
            .with_value(|memory| memory.incomplete.contains(&number))
    }

    /// Whether the records of all these runs are in memory. The others are being loaded.
    pub(crate) fn has_records(self, numbers: &[u32]) -> bool {
        let loaded = numbers
            .iter()
            .filter(|number| self.with_record(**number, |_| ()).is_some());
        loaded.count() == numbers.len()
    }

    /// The findings of a run. They follow `version`.
    pub(crate) fn findings(self, number: u32) -> Option<Rc<Findings>> {
        let header = self.header(number)?;
        let study = header.study()?;
        let measured = header.measured();
        let version = self.version.get();
        let is_running = header.outcome == Outcome::Running;
        let cached = self
            .memory
            .with_value(|memory| memory.findings.get(&number).cloned());
        if let Some((of, findings)) = cached
            && (of == version || !is_running && of == u32::MAX)
        {
            return Some(findings);
        }
        let found = self.with_record(number, |record| study.evaluate(record, &measured))?;
        let found = Rc::new(found);
        // A run that has ended does not change.
        let of = if is_running { version } else { u32::MAX };
        self.memory.update_value(|memory| {
            let cache = &mut memory.findings;
            if cache.len() > RECORDS_MAX {
                cache.clear();
            }
            cache.insert(number, (of, Rc::clone(&found)));
        });
        Some(found)
    }

    pub(super) fn changed(self) {
        self.version
            .update(|version| *version = version.wrapping_add(1) % u32::MAX);
    }
}
