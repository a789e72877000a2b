//! The messages of the worker that writes and reads session files.
//!
//! The page starts that worker when a session is saved or opened. What is saved does not pass through the page: the
//! worker requests it from the recorder, part by part, over a channel between both.

mod problems;
mod replay;

use std::time::Duration;

use motorlink_bus::LineEvent;
use motorlink_protocol::{Faults, Instant, MotorId};
use serde::{Deserialize, Serialize};

pub use problems::{NotASession, Problem};
pub use replay::{ActivityChange, FaultChange, FromReplay, Place, PlaySpeed, ToReplay};

/// From the page to the session worker.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ToSessions {
    /// Save what the recorder keeps. Posted with the channel to the recorder, and with the handle of the file to
    /// write, if the browser has such handles.
    Save {
        /// The version of the page.
        version: String,
        /// The setup as JSON.
        setup: String,
        /// The rover of the setup with its measures, as `Vehicle::to_json` of `experiments` writes it; empty if there is none.
        rover: String,
        /// How much of what the recorder keeps.
        range: SaveRange,
    },
    /// Cancel the saving.
    CancelSave,
    /// Open a file, and close the one before. Posted with the `File`.
    Open {
        /// Its name.
        name: String,
    },
    /// Write the open session as another file.
    Export(SessionExport),
    /// Write a copy of the open session with these bookmarks instead of its own. Answered as an export, with
    /// [`SessionExport::Copy`].
    SaveCopy(Vec<Bookmark>),
    /// Add the runs of experiments in the open session to those that the browser keeps.
    KeepRuns,
    /// Cancel opening and exporting.
    CancelReading,
    /// Replay the open session.
    Replay(ToReplay),
}

/// How much of what the recorder keeps is saved. A file has one line only: what one adapter, or one set of virtual motors,
/// has carried until another was connected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SaveRange {
    /// All of the last line.
    #[default]
    Line,
    /// Of it only so much, up to the newest record.
    Last(Duration),
    /// All of the line before it.
    LineBefore,
    /// From the first to the last sample of the recording, of the line of the last one.
    Recording,
}

/// Another file of an open session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SessionExport {
    /// The packet log as CSV.
    Log,
    /// Every reply for plotting, as CSV.
    Plot,
    /// A report, as HTML.
    Report,
    /// A copy with other bookmarks: see [`ToSessions::SaveCopy`].
    Copy,
}

/// From the session worker to the page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromSessions {
    /// The progress of saving.
    Saving(Progress),
    /// The session is saved. Posted with a `Blob` if the worker had no file to write.
    Saved {
        /// Bytes of the file.
        bytes: u64,
        /// Entries of the packet log and samples in it.
        records: u64,
        /// The runs of experiments in it.
        runs: RunsSaved,
    },
    /// No session was saved.
    NotSaved(NotSaved),
    /// The progress of opening or exporting.
    Reading(Progress),
    /// A file is open.
    Opened(Box<SessionInfo>),
    /// The file is no session, or, without a reason, the browser cannot read it: when opening or exporting.
    NotOpened(Option<NotASession>),
    /// The browser has no room for what was being made of the file: when opening a CSV file or exporting.
    NoRoom,
    /// An export is complete. Posted with a `Blob`.
    Exported {
        /// Which.
        what: SessionExport,
        /// Problems that reading every record has found, and how often.
        problems: Vec<(Problem, u64)>,
    },
    /// The runs of the open session are among those that the browser keeps; `None` if it keeps none now.
    RunsKept(Option<RunsKept>),
    /// Opening or exporting was cancelled.
    Cancelled,
    /// The replay of the open session.
    Replay(FromReplay),
    /// The worker has failed.
    Died,
}

/// The runs of experiments in a saved session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunsSaved {
    /// How many there are.
    pub saved: u32,
    /// Whether others are missing, because the browser could not read them.
    pub is_incomplete: bool,
}

/// What became of the runs of experiments in an open session, by number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunsKept {
    /// Added.
    pub added: u32,
    /// The browser had kept them already.
    pub known: u32,
    /// Unreadable: damaged, or of a later version.
    pub unreadable: u32,
    /// There was no room for them: for so many runs or bytes.
    pub no_room: u32,
    /// The browser could not store them, such as on a full disk.
    pub not_stored: u32,
}

/// A part of a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Progress {
    /// The completed part.
    pub done: u64,
    /// The whole.
    pub of: u64,
}

impl Progress {
    /// The completed part, in per mille.
    #[must_use]
    pub fn per_mille(self) -> u64 {
        (self.done.saturating_mul(1000))
            .checked_div(self.of)
            .unwrap_or(0)
            .min(1000)
    }
}

/// Why no session was saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotSaved {
    /// The recorder keeps nothing.
    Nothing,
    /// The previous session is being restored.
    Restoring,
    /// The log was cleared, restored or erased meanwhile.
    Changed,
    /// The user cancelled it.
    Cancelled,
    /// The disk is full.
    NoRoom,
    /// The file cannot be written.
    Failed,
    /// The recorder does not answer.
    NoRecorder,
}

/// What is in an open session.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SessionInfo {
    /// The name of the file.
    pub name: String,
    /// Bytes of the file.
    pub bytes: u64,
    /// The version of the page that wrote it; empty if it is unknown.
    pub version: String,
    /// The setup of the page that wrote it, as JSON; empty if it is unknown.
    pub setup: String,
    /// The time of the first record, in microseconds since 1970, UTC.
    pub from_unix_us: i64,
    /// Time from the first to the last record, in microseconds.
    pub duration_us: u64,
    /// Length of a bucket of time, in microseconds.
    pub bucket_us: u64,
    /// Frames sent.
    pub sent: u64,
    /// Valid frames received.
    pub received: u64,
    /// Requests without a reply.
    pub lost: u64,
    /// Pieces of invalid bytes.
    pub junk: u64,
    /// Every motor that was sent a frame or replied.
    pub motors: Vec<SessionMotor>,
    /// Events, in their order.
    pub marks: Vec<SessionMark>,
    /// Events that are in the file but not in `marks`.
    pub marks_left_out: u64,
    /// The names of the runs of experiments whose data is in the file. One without a name has its number.
    pub runs: Vec<String>,
    /// Runs that are in the file but not in `runs`.
    pub runs_left_out: u64,
    /// What is missing or unreadable, and how often.
    pub problems: Vec<(Problem, u64)>,
}

/// A motor in a session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SessionMotor {
    /// Its ID.
    pub id: MotorId,
    /// Valid replies.
    pub replies: u64,
    /// Requests without a reply.
    pub lost: u64,
    /// Every fault that it reported.
    pub faults: Faults,
    /// The highest temperature, in degrees Celsius.
    pub temperature_max_c: Option<u8>,
    /// Least and greatest speed in rpm of each bucket of time; `None` without a reply.
    pub speeds: Vec<Option<[i16; 2]>>,
    /// Least and greatest current in raw units of each bucket of time; `None` without a reply that has a current.
    pub currents: Vec<Option<[i16; 2]>>,
}

/// An event of a session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SessionMark {
    /// Microseconds since the first record.
    pub after_us: u64,
    /// Whether it is an error.
    pub error: bool,
    /// Its text, in English, or the note of the user.
    pub text: String,
    /// Whether it is a bookmark of the user.
    pub is_bookmark: bool,
}

/// A bookmark of a session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Bookmark {
    /// Microseconds since the first record.
    pub after_us: u64,
    /// The note of the user.
    pub text: String,
}

/// The answer of the recorder to a request for the next part of what it keeps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Kept {
    /// The next part.
    Part {
        /// The wall clock at [`Instant::ZERO`], in microseconds since 1970.
        zero_us: i64,
        /// How much was answered, this part included.
        progress: Progress,
        /// The records, oldest first.
        records: Vec<KeptRecord>,
        /// Whether there are no more.
        is_last: bool,
    },
    /// There is none: a previous session is being restored.
    Restoring,
    /// There is none: the log was cleared, restored or erased meanwhile.
    Changed,
}

/// An entry of the packet log, a sample, or a state of the page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum KeptRecord {
    /// An event of the line.
    Line(LineEvent),
    /// A message of the page.
    Message {
        /// When.
        at: Instant,
        /// Whether it is an error.
        error: bool,
        /// Its text as it is stored: see `motorlink_i18n::untranslated`.
        text: String,
    },
    /// What the page showed from now on.
    State {
        /// When.
        at: Instant,
        /// As [`stored_state`](crate::stored_state) stores it, on a clock of its own.
        stored: Vec<u8>,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_a_share_of_the_whole() {
        let per_mille = |done, of| Progress { done, of }.per_mille();
        assert_eq!(
            [per_mille(0, 0), per_mille(1, 2), per_mille(3, 2)],
            [0, 500, 1000]
        );
        assert_eq!(per_mille(u64::MAX, u64::MAX), 1);
    }
}
