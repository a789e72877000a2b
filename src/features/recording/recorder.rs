//! What the page has of the recorder, and what it asks of it.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    protocol::Instant,
    recorder::{Export, Filter, FromRecorder, RecordingStatus, ToRecorder},
};
use web_sys::Blob;

use crate::{
    features::{
        packet_log::feed::{LogFeed, LogState},
        recording::texts as words,
        saved_session::{actions::Offer, texts as kept_words},
    },
    link::{
        clock::{Clock, page_origin_ms},
        recorder_link::RecorderLink,
    },
    model::{
        desk::{Desk, Dialog, WorkerState},
        log_lines::{self, Line},
    },
    ui::{download::save_blob, format::grouped},
};

/// A file that is being written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Exporting {
    pub(crate) what: Export,
    /// How far it is.
    pub(crate) per_mille: u64,
}

/// The page's side of the recorder.
#[derive(Clone, Copy)]
pub(crate) struct Recorder {
    link: StoredValue<Option<RecorderLink>, LocalStorage>,
    /// Whether it runs, or is being started.
    pub(crate) alive: RwSignal<bool>,
    /// The rows at hand. They change thirty times a second and are no signal.
    pub(crate) feed: StoredValue<LogFeed, LocalStorage>,
    /// What is said of the log; it changes when the list does, at most once a frame.
    pub(crate) log: RwSignal<LogState>,
    pub(crate) recording: RwSignal<RecordingStatus>,
    /// The file that is being written; one at a time.
    pub(crate) exporting: RwSignal<Option<Exporting>>,
    /// The session that the browser keeps, and what is done with it.
    pub(crate) kept: RwSignal<Offer>,
    /// What became of the wish to erase everything that is kept.
    pub(crate) erased: RwSignal<&'static str>,
}

impl Recorder {
    pub(crate) fn new() -> Self {
        Self {
            link: StoredValue::new_local(None),
            alive: RwSignal::new(true),
            feed: StoredValue::new_local(LogFeed::default()),
            log: RwSignal::new(LogState::default()),
            recording: RwSignal::new(RecordingStatus::default()),
            exporting: RwSignal::new(None),
            kept: RwSignal::new(Offer::None),
            erased: RwSignal::new(""),
        }
    }
}

/// Lines that are kept until there is a recorder: more than a person brings about in that second.
const EARLY_LINES_MAX: usize = 32;

/// As many entries are not forgotten without a question.
const ASKED_ABOVE: u64 = 1000;

impl Desk {
    /// Starts the recorder and lays the line from the worker that owns the port.
    pub(crate) fn start_recorder(self) {
        let started = RecorderLink::spawn(
            move |message, file| self.hear_recorder(message, file),
            move || self.recorder_lost(),
        );
        let Ok(recorder) = started else {
            self.recorder_lost();
            return;
        };
        self.link.with_value(|worker| {
            if let Some(worker) = worker {
                recorder.connect(worker);
            }
        });
        self.recorder.link.set_value(Some(recorder));
        if self.worker.get_untracked() == WorkerState::Dead {
            // No worker tells its epoch, and the page's moments are on its own clock.
            self.set_epoch(page_origin_ms());
        }
        let collapse = self
            .preferences
            .with_untracked(|chosen| chosen.collapse_polls);
        self.tell_language(self.language.get_untracked());
        self.refilter(|filter| filter.collapse = collapse);
    }

    /// The wall clock at the zero of every [`Instant`]. From now on lines have their place in the log.
    pub(crate) fn set_epoch(self, unix_ms: f64) {
        self.tell_recorder(&ToRecorder::Epoch { unix_ms });
        let early = self
            .early_lines
            .lock()
            .ok()
            .and_then(|mut early| early.take());
        for (at, line) in early.unwrap_or_default() {
            let page_ms = Clock::default().page_ms(at);
            self.log(self.clock.get_value().instant(page_ms), line);
        }
    }

    /// Writes a line of the page's own into the log.
    pub(crate) fn log(self, at: Instant, line: Line) {
        if let Ok(mut early) = self.early_lines.lock()
            && let Some(early) = early.as_mut()
        {
            if early.len() < EARLY_LINES_MAX {
                early.push((at, line));
            }
            return;
        }
        let Line { error, text } = line;
        self.tell_recorder(&ToRecorder::Say { at, error, text });
    }

    /// Changes which entries the log shows.
    pub(crate) fn refilter(self, change: impl FnOnce(&mut Filter)) {
        let filter = self
            .recorder
            .feed
            .try_update_value(|feed| feed.refilter(change));
        if let Some(filter) = filter.flatten() {
            self.tell_recorder(&filter);
            self.look();
        }
    }

    /// Asks for the rows that are seen now, where they are others than before.
    pub(crate) fn look(self) {
        let look = self.recorder.feed.try_update_value(LogFeed::look);
        if let Some(look) = look.flatten() {
            self.tell_recorder(&look);
        }
    }

    /// Forgets the log, after a question where it is long.
    pub(crate) fn ask_to_clear_log(self) {
        let kept = self.recorder.log.with_untracked(|log| log.kept);
        if kept > ASKED_ABOVE {
            self.dialog.set(Some(Dialog::ClearLog(kept)));
        } else {
            self.clear_log();
        }
    }

    pub(crate) fn clear_log(self) {
        self.dialog.set(None);
        if let Some(clear) = self.recorder.feed.try_update_value(LogFeed::clear) {
            self.tell_recorder(&clear);
            self.look();
        }
    }

    /// Has a file made, or ends the one that is being made.
    pub(crate) fn export_or_cancel(self, what: Export) {
        if self.recorder.exporting.get_untracked().is_some() {
            self.tell_recorder(&ToRecorder::CancelExport);
            return;
        }
        self.exporting(what, 0);
        self.tell_recorder(&match what {
            Export::Log => ToRecorder::ExportLog,
            Export::Telemetry => ToRecorder::ExportTelemetry,
        });
    }

    pub(crate) fn record(self, on: bool) {
        self.tell_recorder(&ToRecorder::Record(on));
    }

    fn exporting(self, what: Export, per_mille: u64) {
        let exporting = Exporting { what, per_mille };
        self.recorder.exporting.set(Some(exporting));
    }

    pub(crate) fn tell_recorder(self, message: &ToRecorder) {
        self.recorder.link.with_value(|link| {
            if let Some(link) = link {
                link.post(message);
            }
        });
    }

    fn hear_recorder(self, message: FromRecorder, file: Option<Blob>) {
        match message {
            FromRecorder::Log(page) => {
                let again = self.recorder.feed.try_update_value(|feed| feed.take(page));
                if let Some(filter) = again.flatten() {
                    self.tell_recorder(&filter);
                    self.look();
                }
            }
            FromRecorder::Recording(status) => self.recorder.recording.set(status),
            FromRecorder::Exporting { what, done, of } => {
                self.exporting(what, (done * 1000).checked_div(of).unwrap_or(0));
            }
            FromRecorder::Exported { name, rows, .. } => {
                self.recorder.exporting.set(None);
                if let Some(file) = file {
                    save_blob(&file, &name);
                    self.log_now(log_lines::calm(tr!(
                        "Exported {rows} rows to {name}",
                        rows = grouped(rows),
                        name
                    )));
                }
            }
            FromRecorder::NotExported { what, cancelled } => {
                self.recorder.exporting.set(None);
                if cancelled {
                    self.log_now(log_lines::calm(tr!("Export was cancelled")));
                } else {
                    self.say(words::of_nothing_to_export(what));
                }
            }
            FromRecorder::Kept(session) => self.recorder.kept.set(Offer::Open(session)),
            FromRecorder::Restored => self.session_restored(),
            FromRecorder::Past { zero_us, samples } => self.recall(zero_us, &samples),
            FromRecorder::Erased { all } => self.kept_data_erased(all),
            FromRecorder::NotKept(why) => self.log_now(kept_words::of_not_kept(why)),
            FromRecorder::Died => self.recorder_lost(),
        }
    }

    /// The recorder has failed: the log is lost, and nothing else.
    fn recorder_lost(self) {
        if !self.recorder.alive.get_untracked() {
            return;
        }
        self.recorder.alive.set(false);
        self.recorder.link.with_value(|link| {
            if let Some(link) = link {
                link.end();
            }
        });
        self.recorder.feed.update_value(LogFeed::lose);
        self.recorder.recording.set(RecordingStatus::default());
        self.recorder.exporting.set(None);
        self.recorder.kept.set(Offer::None);
        // Where the other worker has failed too, the page says that instead.
        if self.worker.get_untracked() != WorkerState::Dead {
            self.say(words::of_dead_recorder());
        }
    }

    pub(crate) fn log_now(self, line: Line) {
        self.log(self.now(), line);
    }
}
