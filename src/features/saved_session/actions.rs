//! What the browser keeps: the session that is offered, and everything erased.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{CommandRate, Limits, Sample},
    recorder::{KeptSession, ToRecorder},
};

use crate::{
    features::{
        packet_log::feed::LogFeed, recording::texts::no_recorder, saved_session::texts as words,
    },
    model::{
        desk::{Desk, Dialog},
        fleet::Fleet,
        history::History,
        log_lines,
        preferences::{Model, Preferences, forget_all},
        setup::Setup,
    },
};

/// A session that the browser keeps, and what is done with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Offer {
    /// There is none, or the person has turned away from it: then it is offered again with the next visit.
    #[default]
    None,
    /// It can be restored or forgotten.
    Open(KeptSession),
    /// It is being restored.
    Restoring(KeptSession),
}

impl Desk {
    /// Has the session that is offered taken in. It starts no wheel and brings no setpoint back: it is log
    /// and recording.
    pub(crate) fn restore_session(self) {
        if let Offer::Open(session) = self.recorder.kept.get_untracked() {
            self.recorder.kept.set(Offer::Restoring(session));
            self.tell_recorder(&ToRecorder::Restore);
        }
    }

    /// Has it removed.
    pub(crate) fn forget_session(self) {
        if let Offer::Open(session) = self.recorder.kept.get_untracked() {
            self.recorder.kept.set(Offer::None);
            self.tell_recorder(&ToRecorder::Forget);
            self.log_now(log_lines::calm(words::of_forgotten(&session)));
        }
    }

    pub(crate) fn session_restored(self) {
        self.recorder.feed.update_value(LogFeed::renumbered);
        self.history.update_value(History::begin_past);
        self.look();
        if let Offer::Restoring(session) = self.recorder.kept.get_untracked() {
            self.log_now(log_lines::calm(words::of_restored(&session)));
        }
        self.recorder.kept.set(Offer::None);
    }

    /// Takes a part of the restored samples into the graph.
    pub(crate) fn recall(self, zero_us: i64, samples: &[Sample]) {
        let was_empty = self.history.try_update_value(|history| {
            let was_empty = history.reported().is_empty();
            history.recall(zero_us, samples);
            was_empty
        });
        if was_empty == Some(true) {
            // Without motors nothing else updates the page.
            self.show();
        }
    }

    /// Why nothing can be erased now, where a setup could not be taken in for this reason either.
    pub(crate) fn why_not_erase(self, in_use: Option<String>) -> Option<String> {
        if !self.recorder.alive.get() {
            return Some(no_recorder().to_owned());
        }
        let records = self.recorder.recording.with(|status| status.recording);
        let records = records.then(|| tr!("End the recording first.").to_owned());
        records.or(in_use)
    }

    pub(crate) fn ask_to_erase(self) {
        self.recorder.erased.set("");
        self.dialog.set(Some(Dialog::EraseKept));
    }

    /// Erases what is kept, and goes on as a page that is visited for the first time.
    pub(crate) fn erase_kept(self) {
        // Driving or recording may have begun while the question was open.
        let in_use = untrack(|| self.why_not_import(&self.present()));
        let in_use = in_use.or_else(|| self.why_not_turn_sides());
        if let Some(reason) = untrack(|| self.why_not_erase(in_use)) {
            self.refuse(tr!("Nothing was erased").to_owned(), reason);
            return;
        }
        self.recorder.kept.set(Offer::None);
        let limits = Limits::default();
        self.take_setup(Setup {
            model: Some(Model::default()),
            rate: Some(CommandRate::default()),
            keep_driving: Some(true),
            ramp: Some(0),
            speed_limit: Some(limits.speed_rpm()),
            current_limit: Some(limits.current_ma()),
            temperature_limit: Some(limits.temperature_c()),
            fleet: Some(Fleet::default()),
        });
        let first = Preferences::default();
        self.preferences.set(first);
        self.refilter(|filter| filter.collapse = first.collapse_polls);
        // Last of all: what was done before has been remembered.
        forget_all();
        self.recorder.feed.update_value(LogFeed::renumbered);
        self.tell_recorder(&ToRecorder::Erase);
        self.look();
    }

    pub(crate) fn kept_data_erased(self, all: bool) {
        let words = words::of_erased(all);
        self.recorder.erased.set(words);
        self.log_now(log_lines::calm(words));
    }
}
