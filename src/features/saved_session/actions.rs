//! Actions on the saved session, and deleting all data.

use leptos::prelude::*;
use motorlink_messages::{bus::Sample, recorder::ToRecorder};

use crate::{
    features::saved_session::{offer::Offer, texts},
    model::{history::History, log_lines, page::Page},
};

/// The saved session.
#[derive(Clone, Copy)]
pub(crate) struct SavedSession {
    pub(crate) page: Page,
    /// The offered session and its state.
    pub(crate) offer: RwSignal<Offer>,
}

impl SavedSession {
    pub(crate) fn new(page: Page) -> Self {
        Self {
            page,
            offer: RwSignal::new(Offer::None),
        }
    }

    /// Restores the offered session. It has only log and recording: restoring starts no wheel and restores no
    /// setpoint.
    pub(crate) fn restore(self) {
        if let Offer::Open(session) = self.offer.get_untracked() {
            self.offer.set(Offer::Restoring(session));
            self.page.recorder.post(&ToRecorder::Restore);
        }
    }

    /// Removes it.
    pub(crate) fn forget(self) {
        if let Offer::Open(session) = self.offer.get_untracked() {
            self.offer.set(Offer::None);
            self.page.recorder.post(&ToRecorder::Forget);
            self.page
                .log_now(&|| log_lines::calm(texts::of_forgotten(&session)));
        }
    }

    pub(crate) fn restored(self) {
        self.page.history.update_value(History::begin_past);
        if let Offer::Restoring(session) = self.offer.get_untracked() {
            self.page
                .log_now(&|| log_lines::calm(texts::of_restored(&session)));
        }
        self.offer.set(Offer::None);
    }

    /// Adds restored samples to the graph.
    pub(crate) fn recall(self, zero_us: i64, samples: &[Sample]) {
        let was_empty = self.page.history.try_update_value(|history| {
            let was_empty = history.reported().is_empty();
            history.recall(zero_us, samples);
            was_empty
        });
        if was_empty == Some(true) {
            // Without motors nothing else updates the page.
            self.page.show();
        }
    }
}
