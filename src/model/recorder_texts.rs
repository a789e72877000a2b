//! Texts about the recorder and its files.

use motorlink_i18n::tr;
use motorlink_messages::recorder::Export;

use crate::model::{
    help_topic::HelpTopic,
    notice_board::{NoticeText, Tone, Topic},
};

/// Why the log cannot be used any more.
pub(crate) fn no_recorder() -> &'static str {
    tr!("The packet log has stopped. Reload the page to restart it.")
}

/// The recorder has failed, or did not start.
pub(crate) fn of_dead_recorder() -> NoticeText {
    NoticeText::new(
        Topic::Recorder,
        Tone::Error,
        tr!("The packet log and the recording have stopped"),
        &[
            tr!("Motors keep running. The log and the recording are lost."),
            tr!("To restart the log, stop the motors and reload the page."),
        ],
    )
    .explained_at(HelpTopic::Troubleshooting)
}

/// There is nothing to export.
pub(crate) fn of_nothing_to_export(what: Export) -> NoticeText {
    let (title, advice) = match what {
        Export::Log => (
            tr!("The packet log is empty: no file created"),
            tr!("Connect a motor to log its frames."),
        ),
        Export::Telemetry | Export::Plot => (
            tr!("No samples yet: no file created"),
            tr!("Connect a motor. Replies of the last 10 minutes are stored."),
        ),
    };
    NoticeText::new(Topic::Export, Tone::Calm, title, &[advice])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dead_recorder_says_that_driving_goes_on() {
        let words = of_dead_recorder();
        assert_eq!(words.topic, Topic::Recorder);
        assert!(words.advice.join(" ").contains("Motors keep running"));
        for what in [Export::Log, Export::Telemetry, Export::Plot] {
            assert!(of_nothing_to_export(what).title.contains("no file"));
        }
    }
}
