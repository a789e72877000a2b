//! Actions of the packet log.

use leptos::prelude::*;
use motorlink_i18n::Language;
use motorlink_messages::recorder::{Filter, LogPage};
use web_sys::HtmlElement;

use crate::{
    features::packet_log::{
        feed::{LogFeed, LogState},
        painter::{height_of, scroll_px, width_of},
    },
    model::page::{Dialog, Page},
};

/// From this number of entries on, clearing asks first.
const ASKED_ABOVE: u64 = 1000;

/// The packet log.
#[derive(Clone, Copy)]
pub(crate) struct Log {
    pub(crate) page: Page,
    /// The received rows. They change thirty times a second and are no signal.
    pub(crate) feed: StoredValue<LogFeed, LocalStorage>,
    /// The counts of the log; updated with the list, at most once per frame of the screen.
    pub(crate) state: RwSignal<LogState>,
}

impl Log {
    pub(crate) fn new(page: Page) -> Self {
        Self {
            page,
            feed: StoredValue::new_local(LogFeed::default()),
            state: RwSignal::new(LogState::default()),
        }
    }

    /// Changes which entries the log shows.
    pub(crate) fn refilter(self, change: impl FnOnce(&mut Filter)) {
        let filter = self.feed.try_update_value(|feed| feed.refilter(change));
        if let Some(filter) = filter.flatten() {
            self.page.recorder.post(&filter);
            self.request_rows();
        }
    }

    /// Requests the visible rows, if they differ from the last request.
    pub(crate) fn request_rows(self) {
        let request = self.feed.try_update_value(LogFeed::request);
        if let Some(request) = request.flatten() {
            self.page.recorder.post(&request);
        }
    }

    /// Opens or closes collapsed frames by the button of this row.
    pub(crate) fn toggle(self, row: u64) {
        let toggle = |feed: &mut LogFeed| {
            let row = feed.row(row)?.clone();
            Some(feed.toggle(&row))
        };
        if let Some(toggle) = self.feed.try_update_value(toggle).flatten() {
            self.page.recorder.post(&toggle);
            self.request_rows();
        }
    }

    /// Clears the log, after a question if it is long.
    pub(crate) fn ask_to_clear(self) {
        let kept = self.state.with_untracked(|log| log.kept);
        if kept > ASKED_ABOVE {
            self.page.dialog.set(Some(Dialog::ClearLog(kept)));
        } else {
            self.clear();
        }
    }

    pub(crate) fn clear(self) {
        self.page.dialog.set(None);
        if let Some(clear) = self.feed.try_update_value(LogFeed::clear) {
            self.page.recorder.post(&clear);
            self.request_rows();
        }
    }

    /// Follows the newest rows, or stays.
    pub(crate) fn follow(self, follow: bool) {
        self.feed.update_value(|feed| {
            if follow {
                feed.view.follow();
            } else {
                feed.view.stop_following();
            }
            feed.wake();
        });
    }

    /// Handles a move of the scroll bar, also by a change of size. Returns whether the user moved it.
    pub(crate) fn scrolled(self, scroller: &HtmlElement) -> bool {
        let receive = |feed: &mut LogFeed| {
            let place_px = scroll_px(scroller);
            let by_person = if feed.view.resize(width_of(scroller), height_of(scroller)) {
                feed.view.stands_at(place_px);
                false
            } else {
                feed.view.scrolled(place_px)
            };
            feed.wake();
            by_person
        };
        self.feed.try_update_value(receive).unwrap_or(false)
    }

    /// Updates the counts.
    pub(crate) fn show(self) {
        let state = self.feed.with_value(LogFeed::state);
        if self.state.get_untracked() != state {
            self.state.set(state);
        }
    }

    /// Sets the language of the entries, which the recorder writes.
    pub(crate) fn set_language(self, language: Language) {
        let speak = self
            .feed
            .try_update_value(|feed| feed.set_language(language));
        if let Some(speak) = speak {
            self.page.recorder.post(&speak);
            self.request_rows();
        }
    }

    /// Handles received rows.
    pub(crate) fn take(self, rows: LogPage) {
        let again = self.feed.try_update_value(|feed| feed.take(rows));
        if let Some(filter) = again.flatten() {
            self.page.recorder.post(&filter);
            self.request_rows();
        }
    }

    /// The rows were renumbered: a session was restored, or all data was deleted.
    pub(crate) fn renumbered(self) {
        self.feed.update_value(LogFeed::renumbered);
    }

    /// The recorder has failed.
    pub(crate) fn lost(self) {
        self.feed.update_value(LogFeed::lose);
    }
}
