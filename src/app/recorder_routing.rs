//! The messages of the recorder, passed on to the features.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::recorder::{FromRecorder, RecordingStatus};
use web_sys::Blob;

use crate::{
    app::features::Features,
    features::saved_session::{offer::Offer, texts},
    link::{recorder_link::RecorderLink, worker_link::WorkerState},
    model::{
        log_lines,
        recorder::Exporting,
        recorder_texts,
        replay::{self, Crossing},
    },
    ui::{clock::page_origin_ms, download::save_blob, format::grouped},
};

impl Features {
    /// Starts the recorder and connects it to the port worker.
    pub(crate) fn start_recorder(self) {
        let started = RecorderLink::spawn(
            move |message, file| self.on_recorder_message(message, file),
            move || self.recorder_lost(),
        );
        let Ok(recorder) = started else {
            self.recorder_lost();
            return;
        };
        self.page.worker.link.with_value(|worker| {
            if let Some(worker) = worker {
                recorder.connect(worker);
            }
        });
        self.page.recorder.link.set_value(Some(recorder));
        if self.page.worker.state.get_untracked() == WorkerState::Dead {
            // Without a port worker, times are on the page's clock.
            self.page.set_epoch(page_origin_ms());
        }
        let collapse = self
            .page
            .preferences
            .with_untracked(|chosen| chosen.collapse_polls);
        self.log.set_language(self.page.language.get_untracked());
        self.log.refilter(|filter| filter.collapse = collapse);
    }

    fn on_recorder_message(self, message: FromRecorder, file: Option<Blob>) {
        if replay::keeps(Crossing::FromRecorder(&message)) {
            return;
        }
        let recorder = &self.page.recorder;
        match message {
            FromRecorder::Log(rows) => self.log.take(rows),
            FromRecorder::Recording(status) => recorder.report(status),
            FromRecorder::Exporting { what, done, of } => {
                let per_mille = (done * 1000).checked_div(of).unwrap_or(0);
                recorder.exporting.set(Some(Exporting { what, per_mille }));
            }
            FromRecorder::Exported { name, rows, .. } => {
                recorder.exporting.set(None);
                if let Some(file) = file {
                    save_blob(&file, &name);
                    self.page.log_now(&|| {
                        log_lines::calm(tr!(
                            "Exported {rows} rows to {name}",
                            rows = grouped(rows),
                            name
                        ))
                    });
                }
            }
            FromRecorder::NotExported { what, cancelled } => {
                recorder.exporting.set(None);
                if cancelled {
                    self.page
                        .log_now(&|| log_lines::calm(tr!("Export cancelled")));
                } else {
                    self.page
                        .notify(&|| recorder_texts::of_nothing_to_export(what));
                }
            }
            FromRecorder::SavedSessionFound(session) => {
                self.saved_session.offer.set(Offer::Open(session));
            }
            FromRecorder::Restored => {
                self.log.renumbered();
                self.saved_session.restored();
                self.log.request_rows();
            }
            FromRecorder::Past { zero_us, samples } => self.saved_session.recall(zero_us, &samples),
            FromRecorder::Erased { all } => self.settings.was_erased(all),
            FromRecorder::NotSaved(why) => self.page.log_now(&|| texts::of_not_saved(why)),
            FromRecorder::Died => self.recorder_lost(),
        }
    }

    /// Handles a failed recorder: the log is lost, and nothing else.
    fn recorder_lost(self) {
        let recorder = &self.page.recorder;
        if !recorder.alive.get_untracked() {
            return;
        }
        recorder.alive.set(false);
        recorder.link.with_value(|link| {
            if let Some(link) = link {
                link.end();
            }
        });
        self.log.lost();
        recorder.report(RecordingStatus::default());
        recorder.exporting.set(None);
        self.saved_session.offer.set(Offer::None);
        // If the port worker has failed too, the page reports that instead.
        if self.page.worker.state.get_untracked() != WorkerState::Dead {
            self.page.notify(&recorder_texts::of_dead_recorder);
        }
    }
}
