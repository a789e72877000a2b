//! The page's part of the packet log: the received rows, the visible ones, and the filter. Plain data; the list
//! draws it once per frame of the screen.

use std::rc::Rc;

use motorlink_i18n::Language;
use motorlink_messages::recorder::{Filter, LogPage, Row, ToRecorder, Window};

use crate::features::packet_log::view::LogView;

/// The counts and the state of the log, outside of the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LogState {
    /// Entries in the log, visible or not.
    pub(crate) kept: u64,
    /// Entries hidden because they are routine.
    pub(crate) collapsed: u64,
    /// Entries dropped for newer ones.
    pub(crate) gone: u64,
    /// The progress of the filter; 1000 when done.
    pub(crate) filtered_per_mille: u16,
    /// Visible entries.
    pub(crate) shown: u64,
    /// Whether the list follows the newest.
    pub(crate) following: bool,
    /// Rows added since it stopped following.
    pub(crate) new_rows: u64,
}

/// The received rows and the position in the log.
#[derive(Default)]
pub(crate) struct LogFeed {
    pub(crate) view: LogView,
    page: LogPage,
    /// The last requested rows.
    asked: Option<Window>,
    filter: Filter,
    /// The generation of the answers to the last change of the filter or clearing.
    generation: u32,
    /// Consecutive answers of an earlier generation.
    stale: u8,
    /// Wakes the list's animation loop, which sleeps while nothing changes.
    wake: Option<Rc<dyn Fn()>>,
    /// The same, with the next update of readings.
    wake_in_step: Option<Rc<dyn Fn()>>,
}

/// After this number of outdated answers, a second of them, the recorder has missed the change.
const STALE_MAX: u8 = 30;

impl LogFeed {
    /// Handles received rows and counts. An answer from before the last change of the filter is ignored; after
    /// too many of them, this returns the filter, to send it again.
    pub(crate) fn take(&mut self, page: LogPage) -> Option<ToRecorder> {
        let ahead = page.generation.wrapping_sub(self.generation);
        if ahead > u32::MAX / 2 {
            self.stale += 1;
            if self.stale < STALE_MAX {
                return None;
            }
            self.stale = 0;
            self.asked = None;
            return Some(ToRecorder::Filter(self.filter.clone()));
        }
        self.stale = 0;
        self.generation = page.generation;
        self.view.set_rows(page.oldest, page.end);
        self.page = page;
        if let Some(wake) = &self.wake_in_step {
            wake();
        }
        None
    }

    /// The request for the visible rows, if it differs from the last one.
    pub(crate) fn request(&mut self) -> Option<ToRecorder> {
        let window = self.view.window_to_request(self.asked)?;
        self.asked = Some(window);
        Some(ToRecorder::Show(window))
    }

    /// Sets the filter; returns the message for the recorder.
    pub(crate) fn refilter(&mut self, change: impl FnOnce(&mut Filter)) -> Option<ToRecorder> {
        let mut filter = self.filter.clone();
        change(&mut filter);
        if filter == self.filter {
            return None;
        }
        self.filter = filter.clone();
        self.restart();
        Some(ToRecorder::Filter(filter))
    }

    /// Sets the language of the entries. The rows are renumbered, because the search may match others.
    pub(crate) fn set_language(&mut self, language: Language) -> ToRecorder {
        self.restart();
        ToRecorder::SetLanguage {
            language: language.key().to_owned(),
            texts: motorlink_i18n::loaded_texts(language),
        }
    }

    /// The filter.
    pub(crate) fn filter(&self) -> &Filter {
        &self.filter
    }

    /// Opens the collapsed frames before this row, or collapses those that begin with it. The list stays where it is.
    pub(crate) fn toggle(&mut self, row: &Row) -> ToRecorder {
        let (opened, closed) = match row.opened {
            0 => (row.collapsed_before, 0),
            closed => (0, closed),
        };
        self.view.toggled(opened.into(), closed.into());
        self.wake();
        ToRecorder::Toggle(row.number)
    }

    /// Clears the log.
    pub(crate) fn clear(&mut self) -> ToRecorder {
        self.restart();
        ToRecorder::Clear
    }

    /// Restores the entries that were cleared.
    pub(crate) fn undo_clear(&mut self) -> ToRecorder {
        self.restart();
        ToRecorder::EndClear { undo: true }
    }

    /// The recorder has renumbered the rows by itself.
    pub(crate) fn renumbered(&mut self) {
        self.restart();
    }

    /// The rows are renumbered, so old positions are invalid.
    fn restart(&mut self) {
        self.generation = self.generation.wrapping_add(1);
        self.asked = None;
        self.view.follow();
        self.wake();
    }

    /// The recorder has failed, and the log is lost.
    pub(crate) fn lose(&mut self) {
        self.page = LogPage::default();
        self.view.set_rows(0, 0);
        self.view.follow();
        self.wake();
    }

    /// Takes the place of this feed in the list, for another log with the same filter, and returns this one.
    pub(crate) fn exchange(&mut self, other: Self) -> Self {
        let mut view = self.view;
        view.set_rows(other.page.oldest, other.page.end);
        view.follow();
        let next = Self {
            view,
            asked: None,
            wake: self.wake.clone(),
            wake_in_step: self.wake_in_step.clone(),
            ..other
        };
        std::mem::replace(self, next)
    }

    /// A row, if it was received.
    pub(crate) fn row(&self, number: u64) -> Option<&Row> {
        let first = self.page.rows.first()?.number;
        let place = usize::try_from(number.checked_sub(first)?).ok()?;
        let row = self.page.rows.get(place)?;
        (row.number == number).then_some(row)
    }

    /// The counts of the log.
    pub(crate) fn state(&self) -> LogState {
        LogState {
            kept: self.page.kept,
            collapsed: self.page.collapsed,
            gone: self.page.gone,
            filtered_per_mille: self.page.filtered_per_mille,
            shown: self.page.end.saturating_sub(self.page.oldest),
            following: self.view.is_following(),
            new_rows: self.view.new_rows(),
        }
    }

    /// Calls `wake` after a change by the user, `wake_in_step` after new data. They must not access the feed.
    pub(crate) fn on_new_data(&mut self, wake: Rc<dyn Fn()>, wake_in_step: Rc<dyn Fn()>) {
        self.wake = Some(wake);
        self.wake_in_step = Some(wake_in_step);
    }

    pub(crate) fn wake(&self) {
        if let Some(wake) = &self.wake {
            wake();
        }
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::recorder::Kind;

    use super::*;

    fn page(generation: u32, rows: std::ops::Range<u64>) -> LogPage {
        LogPage {
            oldest: 0,
            end: rows.end,
            kept: rows.end,
            generation,
            rows: rows.map(row).collect(),
            ..LogPage::default()
        }
    }

    fn row(number: u64) -> Row {
        Row {
            number,
            kind: Kind::Tx,
            time: String::new(),
            id: String::new(),
            hex: String::new(),
            meaning: number.to_string(),
            collapsed_before: 0,
            opened: 0,
        }
    }

    #[test]
    fn a_row_is_found_by_its_number() {
        let mut feed = LogFeed::default();
        assert_eq!(feed.row(0), None);
        feed.take(page(0, 10..20));
        assert_eq!(feed.row(12).unwrap().meaning, "12");
        assert_eq!(feed.row(9), None);
        assert_eq!(feed.row(20), None);
    }

    #[test]
    fn an_answer_from_before_the_filter_is_passed_over() {
        let mut feed = LogFeed::default();
        assert_eq!(feed.take(page(0, 0..5)), None);
        let filter = feed.refilter(|filter| filter.collapse = true);
        assert!(matches!(filter, Some(ToRecorder::Filter(_))));
        feed.clear();
        feed.take(page(0, 0..7));
        feed.take(page(1, 0..7));
        assert_eq!(feed.state().kept, 5);
        feed.take(page(2, 0..3));
        assert_eq!(feed.state().kept, 3);
    }

    #[test]
    fn a_recorder_that_did_not_hear_of_the_filter_is_told_again() {
        let mut feed = LogFeed::default();
        let filter = feed.refilter(|filter| filter.collapse = true);
        for _ in 1..STALE_MAX {
            assert_eq!(feed.take(page(0, 0..7)), None);
        }
        assert_eq!(feed.take(page(0, 0..7)), filter);
        assert_eq!(feed.take(page(1, 0..3)), None);
        assert_eq!(feed.state().kept, 3);
    }

    #[test]
    fn the_same_filter_is_not_sent_again() {
        let mut feed = LogFeed::default();
        assert_eq!(feed.refilter(|filter| filter.text.clear()), None);
        assert!(feed.refilter(|filter| filter.text.push('a')).is_some());
        assert_eq!(feed.refilter(|filter| filter.text = "a".to_owned()), None);
    }

    #[test]
    fn a_new_filter_goes_to_the_newest_and_asks_again() {
        let mut feed = LogFeed::default();
        feed.view.resize(600, 240);
        feed.take(page(0, 0..100));
        assert!(feed.request().is_some());
        assert_eq!(feed.request(), None);
        feed.view.stop_following();
        assert!(feed.request().is_some());
        feed.refilter(|filter| filter.collapse = true);
        let newest = Window {
            first: None,
            rows: 24,
        };
        assert_eq!(feed.request(), Some(ToRecorder::Show(newest)));
        assert!(feed.state().following);
    }
}
