//! Actions of the packet log.

use std::time::Duration;

use leptos::prelude::*;
use motorlink_i18n::Language;
use motorlink_messages::recorder::{Filter, LogPage, ToRecorder};
use web_sys::HtmlElement;

use crate::{
    features::packet_log::{
        feed::{LogFeed, LogState},
        painter::{height_of, width_of},
    },
    model::page::Page,
    ui::{clock::page_now_ms, list::scroll_px},
};

/// How long clearing can be undone.
const UNDO_FOR: Duration = Duration::from_secs(10);

/// The slowest double click of Windows is 900 ms, the usual one 500 ms.
const DOUBLE_CLICK_MS: f64 = 500.0;

/// The packet log.
#[derive(Clone, Copy)]
pub(crate) struct Log {
    pub(crate) page: Page,
    /// The received rows. They change thirty times a second and are no signal.
    pub(crate) feed: StoredValue<LogFeed, LocalStorage>,
    /// The counts of the log; updated with the list, at most once per frame of the screen.
    pub(crate) state: RwSignal<LogState>,
    /// When it was cleared, in milliseconds of the page, while that can be undone.
    pub(crate) cleared_ms: RwSignal<Option<f64>>,
    /// How often it was cleared.
    clearings: StoredValue<u32>,
}

impl Log {
    pub(crate) fn new(page: Page) -> Self {
        Self {
            page,
            feed: StoredValue::new_local(LogFeed::default()),
            state: RwSignal::new(LogState::default()),
            cleared_ms: RwSignal::new(None),
            clearings: StoredValue::new(0),
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

    /// Clears the log. It can be undone for a while.
    pub(crate) fn clear(self) {
        self.post_and_request_rows(LogFeed::clear);
        let Some(clearing) = self.clearings.try_update_value(|count| {
            *count = count.wrapping_add(1);
            *count
        }) else {
            return;
        };
        self.cleared_ms.set(Some(page_now_ms()));
        set_timeout(
            move || {
                let is_latest = self.clearings.try_get_value() == Some(clearing);
                if is_latest && self.cleared_ms.get_untracked().is_some() {
                    self.cleared_ms.set(None);
                    let undo = false;
                    self.page.recorder.post(&ToRecorder::EndClear { undo });
                }
            },
            UNDO_FOR,
        );
    }

    /// Restores what was cleared. The second click of a double click does not.
    pub(crate) fn undo_clear(self) {
        let cleared_ms = self.cleared_ms.get_untracked();
        if cleared_ms.is_some_and(|cleared_ms| page_now_ms() - cleared_ms > DOUBLE_CLICK_MS) {
            self.cleared_ms.set(None);
            self.post_and_request_rows(LogFeed::undo_clear);
        }
    }

    fn post_and_request_rows(self, message: fn(&mut LogFeed) -> ToRecorder) {
        if let Some(message) = self.feed.try_update_value(message) {
            self.page.recorder.post(&message);
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

    /// Shows another log in the list, with the same filter and in the same language. Returns the feed of the one before.
    pub(crate) fn exchange(self, other: LogFeed) -> LogFeed {
        let before = self.feed.try_update_value(|feed| feed.exchange(other));
        let before = before.unwrap_or_default();
        self.set_language(self.page.language.get_untracked());
        self.refilter(|filter| filter.clone_from(before.filter()));
        before
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
        self.cleared_ms.set(None);
        self.feed.update_value(LogFeed::renumbered);
    }

    /// The recorder has failed.
    pub(crate) fn lost(self) {
        self.cleared_ms.set(None);
        self.feed.update_value(LogFeed::lose);
    }
}
