//! Which messages cross between the recording and the live line.

use std::sync::atomic::Ordering::Relaxed;

use leptos::prelude::Set as _;
use motorlink_messages::{
    ToWorker,
    bus::Command,
    recorder::{FromRecorder, ToRecorder},
    sessions::ToReplay,
};

use crate::{
    features::session_file::player::Player,
    model::{guards::is_in_use, replay::Crossing},
};

impl Player {
    /// Decides which messages cross between the recording and the live line.
    pub(super) fn keeps(self, message: Crossing<'_>) -> bool {
        match message {
            Crossing::ToWorker(message) => self.keeps_from_worker(message),
            Crossing::FromWorker(update) => {
                let is_open = is_in_use(update.connection);
                if is_open {
                    self.end();
                }
                !is_open
            }
            Crossing::WorkerLost => {
                self.end();
                false
            }
            Crossing::ToRecorder(message) => self.keeps_from_recorder(message),
            Crossing::FromRecorder(FromRecorder::Log(_)) => true,
            Crossing::FromRecorder(message) => {
                let replaces_the_log = matches!(
                    message,
                    FromRecorder::Restored | FromRecorder::Past { .. } | FromRecorder::Died
                );
                if replaces_the_log {
                    self.end();
                }
                false
            }
            Crossing::Stop => {
                // In the field of a note that is Escape: Space writes a space there.
                if !self.cancels_note() {
                    self.pause();
                }
                true
            }
            Crossing::Row(number) => {
                self.unreadable.set(false);
                self.plays_at_start.store(false, Relaxed);
                self.post(ToReplay::SeekRow(number));
                true
            }
            Crossing::Moment(at) => {
                self.seek_moment(at);
                true
            }
        }
    }

    /// A second lock: nothing but stops reaches the port worker. What opens a port ends the replay.
    fn keeps_from_worker(self, message: &ToWorker) -> bool {
        match message {
            ToWorker::ConnectSerial { .. } | ToWorker::ConnectVirtual(_) => {
                self.end();
                false
            }
            ToWorker::Disconnect
            | ToWorker::Pong { .. }
            | ToWorker::Command {
                command: Command::StopAll(_) | Command::Stop(_),
                ..
            } => false,
            ToWorker::Command { .. }
            | ToWorker::Select(_)
            | ToWorker::VirtualWire(_)
            | ToWorker::Run { .. } => true,
        }
    }

    /// The packet log is that of the recording; what the page writes is left out of it.
    fn keeps_from_recorder(self, message: &ToRecorder) -> bool {
        let of_replay = match message {
            ToRecorder::Show(rows) => ToReplay::ShowRows(*rows),
            ToRecorder::Filter(filter) => ToReplay::Filter(filter.clone()),
            ToRecorder::Toggle(row) => ToReplay::Toggle(*row),
            ToRecorder::SetLanguage { language, texts } => ToReplay::SetLanguage {
                language: language.clone(),
                texts: texts.clone(),
            },
            ToRecorder::AddMessage { .. }
            | ToRecorder::Clear
            | ToRecorder::EndClear { undo: true }
            | ToRecorder::Export(_)
            | ToRecorder::Record(_) => return true,
            ToRecorder::Restore | ToRecorder::Erase => {
                self.end();
                return false;
            }
            ToRecorder::Epoch { .. }
            | ToRecorder::EndClear { undo: false }
            | ToRecorder::CancelExport
            | ToRecorder::Forget => return false,
        };
        self.post(of_replay);
        true
    }
}
