//! The recorder as the page sees it.

use std::sync::Mutex;

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    protocol::Instant,
    recorder::{Export, RecordingStatus, ToRecorder},
};

use crate::{
    link::recorder_link::RecorderLink,
    model::{
        log_lines::Line,
        recorder_texts::no_recorder,
        replay::{self, Crossing},
    },
};

/// A file that is being written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Exporting {
    pub(crate) what: Export,
    /// Its progress.
    pub(crate) per_mille: u64,
}

/// The recorder and its state.
pub(crate) struct Recorder {
    pub(crate) link: StoredValue<Option<RecorderLink>, LocalStorage>,
    /// Whether it runs, or is being started.
    pub(crate) alive: RwSignal<bool>,
    /// The recording as the page shows it.
    pub(crate) recording: RwSignal<RecordingStatus>,
    /// The recording as last reported.
    reported: Mutex<RecordingStatus>,
    /// The file that is being written; one at a time.
    pub(crate) exporting: RwSignal<Option<Exporting>>,
    /// Messages with times of the page's clock, until the worker's clock is known.
    pub(crate) early_lines: Mutex<Option<Vec<(Instant, Line)>>>,
}

impl Recorder {
    pub(crate) fn new() -> Self {
        Self {
            link: StoredValue::new_local(None),
            alive: RwSignal::new(true),
            recording: RwSignal::new(RecordingStatus::default()),
            reported: Mutex::default(),
            exporting: RwSignal::new(None),
            early_lines: Mutex::new(Some(Vec::new())),
        }
    }

    /// Takes in a report. Numbers wait for the frame in which the rest of the page changes; a start or an end does
    /// not.
    pub(crate) fn report(&self, status: RecordingStatus) {
        if let Ok(mut reported) = self.reported.lock() {
            *reported = status;
        }
        let shown = self.recording.get_untracked();
        let numbers_only = status.recording == shown.recording
            && status.full == shown.full
            && status.exported == shown.exported
            && (status.rolling == 0) == (shown.rolling == 0);
        if !numbers_only {
            self.show();
        }
    }

    /// Shows the last report.
    pub(crate) fn show(&self) {
        if let Ok(reported) = self.reported.lock()
            && self.recording.get_untracked() != *reported
        {
            self.recording.set(*reported);
        }
    }

    pub(crate) fn post(&self, message: &ToRecorder) {
        if replay::keeps(Crossing::ToRecorder(message)) {
            return;
        }
        self.link.with_value(|link| {
            if let Some(link) = link {
                link.post(message);
            }
        });
    }

    /// Starts an export, or cancels the current one.
    pub(crate) fn export_or_cancel(&self, what: Export) {
        if self.exporting.get_untracked().is_some() {
            self.post(&ToRecorder::CancelExport);
            return;
        }
        self.exporting.set(Some(Exporting { what, per_mille: 0 }));
        self.post(&ToRecorder::Export(what));
    }

    /// The progress of this file while it is written.
    pub(crate) fn per_mille(&self, what: Export) -> Option<u64> {
        let exporting = self.exporting.get().filter(|one| one.what == what);
        exporting.map(|one| one.per_mille)
    }

    /// Why this file cannot be exported now, apart from its content.
    pub(crate) fn export_blocked_by(&self, what: Export) -> Option<String> {
        if !self.alive.get() {
            return Some(no_recorder().to_owned());
        }
        let other = self.exporting.get().filter(|one| one.what != what);
        other.map(|_| tr!("Another export is running.").to_owned())
    }
}
