//! What the page has of the packet log: the rows that it asked for, which of them are seen, and
//! which entries the log is to show. Plain data; the list draws from it once a frame.

use std::rc::Rc;

use motorlink_i18n::Language;
use motorlink_messages::recorder::{Filter, LogPage, Row, ToRecorder, Window};

use crate::features::packet_log::view::LogView;

/// Everything about the log that stands outside the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LogState {
    /// Entries that are kept, shown or not.
    pub(crate) kept: u64,
    /// Those that are not shown because they are routine.
    pub(crate) collapsed: u64,
    /// Entries that gave way to newer ones.
    pub(crate) gone: u64,
    /// How far the filter has come; 1000 when it is through.
    pub(crate) filtered_per_mille: u16,
    /// Entries that are shown.
    pub(crate) shown: u64,
    /// Whether the list stays with the newest.
    pub(crate) following: bool,
    /// What has come since it does not.
    pub(crate) new_rows: u64,
}

/// The rows at hand and the place in the log.
#[derive(Default)]
pub(crate) struct LogFeed {
    pub(crate) view: LogView,
    page: LogPage,
    /// What was asked for last.
    asked: Option<Window>,
    filter: Filter,
    /// The generation in which the last change of the filter or clearing will be answered.
    generation: u32,
    /// Answers in a row from before that.
    stale: u8,
    /// Wakes the list, which sleeps while nothing changes.
    wake: Option<Rc<dyn Fn()>>,
    /// The same with the next step of what goes with the data.
    wake_in_step: Option<Rc<dyn Fn()>>,
}

/// So many answers in a row from before the last change, which is a second of them, and the recorder
/// has not heard of it.
const STALE_MAX: u8 = 30;

impl LogFeed {
    /// Takes in rows and counts. An answer from before the last change of the filter is none; where
    /// nothing else comes, the recorder is told of the filter once more, by what is given back.
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

    /// The rows to ask for now, where they are not those that were asked for last.
    pub(crate) fn request(&mut self) -> Option<ToRecorder> {
        let window = self.view.window_to_request(self.asked)?;
        self.asked = Some(window);
        Some(ToRecorder::Show(window))
    }

    /// Changes which entries are shown; what to tell the recorder of it.
    pub(crate) fn refilter(&mut self, change: impl FnOnce(&mut Filter)) -> Option<ToRecorder> {
        let mut filter = self.filter.clone();
        change(&mut filter);
        if filter == self.filter {
            return None;
        }
        self.filter = filter.clone();
        self.begin_anew();
        Some(ToRecorder::Filter(filter))
    }

    /// Puts entries into words in another language, and counts them anew: what is searched for may be in
    /// others now.
    pub(crate) fn set_language(&mut self, language: Language) -> ToRecorder {
        self.begin_anew();
        ToRecorder::SetLanguage {
            language: language.key().to_owned(),
            texts: motorlink_i18n::loaded_texts(language),
        }
    }

    /// Which entries are shown.
    pub(crate) fn filter(&self) -> &Filter {
        &self.filter
    }

    /// Forgets every entry.
    pub(crate) fn clear(&mut self) -> ToRecorder {
        self.begin_anew();
        ToRecorder::Clear
    }

    /// The recorder has numbered the rows anew by itself.
    pub(crate) fn renumbered(&mut self) {
        self.begin_anew();
    }

    /// The rows are numbered anew, so a place among the old ones is none.
    fn begin_anew(&mut self) {
        self.generation = self.generation.wrapping_add(1);
        self.asked = None;
        self.view.follow();
        self.wake();
    }

    /// The recorder is gone, and the log with it.
    pub(crate) fn lose(&mut self) {
        self.page = LogPage::default();
        self.view.set_rows(0, 0);
        self.view.follow();
        self.wake();
    }

    /// A row, where it is at hand.
    pub(crate) fn row(&self, number: u64) -> Option<&Row> {
        let first = self.page.rows.first()?.number;
        let place = usize::try_from(number.checked_sub(first)?).ok()?;
        let row = self.page.rows.get(place)?;
        (row.number == number).then_some(row)
    }

    /// What is said of the log.
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

    /// Calls `wake` when a person changes something, `wake_in_step` when there is something new. They must
    /// not touch the feed.
    pub(crate) fn on_news(&mut self, wake: Rc<dyn Fn()>, wake_in_step: Rc<dyn Fn()>) {
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
    fn a_new_filter_goes_to_the_newest_and_asks_anew() {
        let mut feed = LogFeed::default();
        feed.view.resize(600, 220);
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
