//! Adds the messages of the page to the packet log.

use leptos::prelude::*;
use motorlink_i18n::untranslated;
use motorlink_messages::{protocol::Instant, recorder::ToRecorder};

use crate::{
    link::clock::Clock,
    model::{log_lines::Line, page::Page, recorder::Recorder},
};

/// Messages that wait until the recorder runs: more than a user can cause in that second.
const EARLY_LINES_MAX: usize = 32;

impl Page {
    /// The recorder.
    pub(crate) fn recorder(self) -> &'static Recorder {
        &self.parts().recorder
    }

    /// Sets the wall clock at [`Instant::ZERO`], so that messages can be added to the log.
    pub(crate) fn set_epoch(self, unix_ms: f64) {
        self.recorder.post(&ToRecorder::Epoch { unix_ms });
        let early = self.recorder.early_lines.lock();
        let early = early.ok().and_then(|mut early| early.take());
        for (at, line) in early.unwrap_or_default() {
            let page_ms = Clock::default().shown_ms_of(at);
            self.log(self.worker.clock.get_value().instant(page_ms), line);
        }
    }

    /// Adds a message to the log. It follows the language if it is [`untranslated`].
    pub(crate) fn log(self, at: Instant, line: Line) {
        if let Ok(mut early) = self.recorder.early_lines.lock()
            && let Some(early) = early.as_mut()
        {
            if early.len() < EARLY_LINES_MAX {
                early.push((at, line));
            }
            return;
        }
        let Line { error, text } = line;
        self.recorder
            .post(&ToRecorder::AddMessage { at, error, text });
    }

    /// Adds a message about the present, which follows the language.
    pub(crate) fn log_now(self, line: &dyn Fn() -> Line) {
        self.log(self.now(), untranslated(line));
    }
}
