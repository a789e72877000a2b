//! Commands to the worker, and notices to the user.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{ToWorker, bus::Command, protocol::Instant};

use crate::{
    link::worker_link::WorkerState,
    model::{
        log_lines,
        mirror::to_wire,
        notice_board::{NoticeText, Tone, Topic, Until},
        page::Page,
        replay::{self, Crossing},
        snapshot::Session,
    },
    ui::clock::{act_ms, page_now_ms},
};

/// The worker reports the effect of a command with the next frame of the screen; on a slow page it may take a
/// few frames.
const TOLD_WITHIN_MS: f64 = 500.0;

impl Page {
    pub(crate) fn post(self, message: &ToWorker) {
        if replay::keeps(Crossing::ToWorker(message)) {
            return;
        }
        self.worker.link.with_value(|link| {
            if let Some(link) = link {
                link.post(message);
            }
        });
    }

    /// Sends a command of the operator to the bus.
    pub(crate) fn command(self, command: Command) {
        let mirror = |id| self.motors.names.with_untracked(|names| names.mirror(id));
        if matches!(
            command,
            Command::Start { .. }
                | Command::StartGroup { .. }
                | Command::Drive { .. }
                | Command::DriveGroup { .. }
                | Command::SendRaw { .. }
        ) {
            self.worker.started_ms.set_value(page_now_ms());
        }
        self.post(&ToWorker::Command {
            command: to_wire(command, mirror),
            given_ms: act_ms(),
        });
    }

    /// Why no motor can change its side now: the effect of the last command may not be known yet, and an open
    /// question has the present sign.
    pub(crate) fn side_changes_blocked_by(self) -> Option<String> {
        let just_asked = self.has_just_started();
        let asks = self.dialog.with_untracked(Option::is_some);
        (just_asked || asks).then(|| tr!("A motor is starting. Try again in a moment.").to_owned())
    }

    /// Whether any motor is driven, still moves, or may have been started a moment ago.
    pub(crate) fn is_anything_driven(self) -> bool {
        self.has_just_started() || self.latest.with_value(Session::is_anything_driven)
    }

    /// Whether the worker reports that no motor moves. Unknown is not at rest.
    pub(crate) fn is_known_to_rest(self) -> bool {
        self.worker.state.get_untracked() == WorkerState::Running
            && !self.has_just_started()
            && self.latest.with_value(Session::is_known_to_rest)
    }

    fn has_just_started(self) -> bool {
        page_now_ms() - self.worker.started_ms.get_value() < TOLD_WITHIN_MS
    }

    /// Shows a notice and adds it to the log.
    pub(crate) fn notify(self, text: &dyn Fn() -> NoticeText) {
        self.log_now(&|| log_lines::of_notice(&text()));
        self.show_notice(text(), Until::Dismissed);
    }

    /// Shows a notice, which is withdrawn when `until` occurs.
    pub(crate) fn show_notice(self, text: NoticeText, until: Until) {
        self.notices.update(|board| board.post_until(text, until));
    }

    /// Shows why a command was not sent.
    pub(crate) fn refuse(self, title: String, reason: String) {
        let text = NoticeText {
            topic: Topic::Command,
            tone: Tone::Warning,
            title,
            advice: vec![reason],
            remedy: None,
            help: None,
        };
        self.log(self.now(), log_lines::of_notice(&text));
        self.show_notice(text, Until::Dismissed);
    }

    /// The current time on the worker's clock.
    pub(crate) fn now(self) -> Instant {
        self.worker.clock.get_value().instant(page_now_ms())
    }
}
