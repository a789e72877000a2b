//! Rows of the packet log of a replay, as the recorder sends those of a live one.

use std::time::Duration;

use motorlink_i18n::Language;
use motorlink_messages::{
    recorder::{Filter, Window},
    sessions::FromReplay,
};
use motorlink_protocol::Instant;
use motorlink_recorder::Log;

/// Rows are sent at most 30 times a second.
const PERIOD: Duration = Duration::from_micros(33_400);

/// Entries between two looks at the messages of the page.
const ENTRIES_AT_ONCE: u64 = 2_000;

/// What the page wants to see of the log.
#[derive(Debug, Default)]
pub(super) struct LogRows {
    window: Option<Window>,
    pub(super) filter: Filter,
    pub(super) is_changed: bool,
    sent: Option<Instant>,
}

/// What is next.
#[derive(Debug)]
pub(super) enum Rows {
    Post(FromReplay),
    /// There are more entries to filter.
    Work,
    Wait(Option<Instant>),
}

impl LogRows {
    pub(super) const fn show(&mut self, window: Window) {
        self.window = Some(window);
        self.is_changed = true;
    }

    pub(super) fn set_filter(&mut self, filter: Filter, log: &mut Log) {
        log.filter(&filter);
        self.filter = filter;
        self.is_changed = true;
    }

    pub(super) fn toggle(&mut self, row: u64, log: &mut Log) {
        log.toggle(row);
        self.is_changed = true;
    }

    pub(super) fn set_language(&mut self, language: &str, texts: Option<String>, log: &mut Log) {
        let language = Language::from_tag(language).unwrap_or_default();
        if let Some(texts) = texts {
            // Texts of another version are refused; the rows stay in English then.
            let _ = motorlink_i18n::load_texts(language, texts);
        }
        motorlink_i18n::set_language(language);
        // In the new language, the search may match other entries.
        log.filter(&self.filter);
        self.is_changed = true;
    }

    pub(super) fn poll(&mut self, now: Instant, log: &mut Log) -> Rows {
        let due = self.sent.map_or(now, |sent| sent + PERIOD);
        let window = self.window.filter(|_| self.is_changed);
        if let Some(window) = window.filter(|_| due <= now) {
            self.is_changed = false;
            self.sent = Some(now);
            return Rows::Post(FromReplay::Log {
                rows: Box::new(log.page(window)),
                frame: log.newest_frame().map(Box::new),
            });
        }
        if !log.is_filtered() {
            log.advance(ENTRIES_AT_ONCE);
            self.is_changed = true;
            return Rows::Work;
        }
        Rows::Wait(window.map(|_| due))
    }
}
