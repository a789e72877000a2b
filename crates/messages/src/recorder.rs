//! The messages between the page and the recorder, the worker that keeps the packet log and the recording.
//!
//! Frames do not pass through the page: the port worker posts them to the recorder as consecutive
//! [`LineEvent`]s, each encoded by [`encode`](crate::encode).

use motorlink_bus::{LineEvent, Sample};
use motorlink_protocol::{Instant, MotorId};
use serde::{Deserialize, Serialize};

/// From the page to the recorder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToRecorder {
    /// The wall clock at [`Instant::ZERO`]: the port worker's `performance.timeOrigin`.
    Epoch {
        /// In milliseconds since 1970, UTC.
        unix_ms: f64,
    },
    /// Add a message of the page to the log.
    AddMessage {
        /// When.
        at: Instant,
        /// Whether it is an error.
        error: bool,
        /// The text, one line: as it is shown, or made within `motorlink_i18n::untranslated`.
        text: String,
    },
    /// Show these rows of the packet log. Answered by a [`LogPage`], and by another whenever one of these
    /// rows or a count changes; at most 30 times a second.
    Show(Window),
    /// Use this language for the rows and the search. Files are in English. Messages that are not
    /// `untranslated` stay as they are. The rows are renumbered.
    SetLanguage {
        /// The language: `en`, `zh` or `de`.
        language: String,
        /// The file of its texts, unless the recorder's program contains them.
        texts: Option<String>,
    },
    /// Set the filter. The rows are renumbered.
    Filter(Filter),
    /// Open the hidden routine entries directly before this row, or hide again those that begin with it. The rows before
    /// it keep their numbers.
    Toggle(u64),
    /// Clear the log, and keep its entries aside. The recording stays.
    Clear,
    /// Restore the entries before the last [`ToRecorder::Clear`], or free them. The rows are renumbered if they are
    /// restored.
    EndClear {
        /// Whether to restore them.
        undo: bool,
    },
    /// Export a CSV file.
    Export(Export),
    /// Cancel all exports.
    CancelExport,
    /// Start or stop recording. Samples are appended until the recording has been exported.
    Record(bool),
    /// Restore the offered session: its entries and samples precede those of this session.
    Restore,
    /// Remove the offered session.
    Forget,
    /// Remove all saved sessions, and clear log and recording. The rows are renumbered.
    Erase,
}

/// A range of rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Window {
    /// Number of the first row; `None` for the newest rows.
    pub first: Option<u64>,
    /// Number of rows, at most [`Window::ROWS_MAX`].
    pub rows: u16,
}

impl Window {
    /// Five screens.
    pub const ROWS_MAX: u16 = 400;
}

/// Which entries the log shows: those that satisfy all conditions.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Filter {
    /// A text in a row's time, ID, hex or meaning, ignoring case. Empty matches everything.
    pub text: String,
    /// From or to this motor.
    pub id: Option<MotorId>,
    /// Of this kind.
    pub kind: Option<Kind>,
    /// Without routine exchanges: feedback queries, unchanged drive frames, and their valid replies.
    pub collapse: bool,
}

/// The kind of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// A sent frame.
    Tx,
    /// A valid frame of a motor.
    Rx,
    /// A message of the page.
    System,
    /// An error: invalid bytes, a missing reply, or an error message of the page.
    Error,
}

/// From the recorder to the page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromRecorder {
    /// Rows of the log, and its counts.
    Log(LogPage),
    /// The state of the recording; sent when it changes, at most five times a second.
    Recording(RecordingStatus),
    /// The progress of an export; [`FromRecorder::Exported`] follows at the end.
    Exporting {
        /// Which.
        what: Export,
        /// Rows written.
        done: u64,
        /// Rows in all.
        of: u64,
    },
    /// A file is complete. This message is posted with a `Blob`.
    Exported {
        /// Which.
        what: Export,
        /// The file name.
        name: String,
        /// Its rows, without the header.
        rows: u64,
    },
    /// No file was written: there was nothing to export, or the export was cancelled.
    NotExported {
        /// Which.
        what: Export,
        /// Whether the user cancelled it.
        cancelled: bool,
    },
    /// A saved session was found. It is offered until it is restored or removed.
    SavedSessionFound(SavedSession),
    /// The offered session is restored. The rows are renumbered.
    Restored,
    /// The last ten minutes of restored samples, after [`FromRecorder::Restored`]. The newest part comes
    /// first; each part has at most [`PAST_SAMPLES_MAX`] samples, oldest first.
    Past {
        /// How much later the zero of their times is than the zero of other [`Instant`]s, in microseconds.
        /// Usually negative.
        zero_us: i64,
        /// The samples.
        samples: Vec<Sample>,
    },
    /// The saved sessions have been removed.
    Erased {
        /// Whether nothing is left; sessions that other tabs have open are not removed.
        all: bool,
    },
    /// The session is no longer saved; log and recording continue in memory.
    NotSaved(NotSaved),
    /// The recorder has failed; the log and the recording are lost.
    Died,
}

/// Restored samples in one message: the page processes them within a few milliseconds.
pub const PAST_SAMPLES_MAX: u16 = 2_000;

/// A saved session.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedSession {
    /// The time of its first entry, in milliseconds since 1970, UTC.
    pub from_ms: f64,
    /// The time of its last entry.
    pub to_ms: f64,
    /// Line events in its log.
    pub packets: u64,
    /// Recorded samples.
    pub recorded: u64,
    /// Recorded time, in milliseconds.
    pub recorded_ms: u64,
}

/// Why the session is not saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotSaved {
    /// The browser has no room for it.
    NoRoom,
    /// Its storage fails.
    Failed,
}

/// The kind of an exported file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Export {
    /// Every entry of the packet log, visible or not.
    Log,
    /// The recorded samples, or the last ten minutes if none were recorded, in the columns of the article.
    Telemetry,
    /// The same samples for plotting: elapsed seconds, then measured and commanded values.
    Plot,
}

/// Rows of the log, and its counts.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogPage {
    /// Number of the oldest row. It grows when old entries are dropped; a row keeps its number until the
    /// filter changes or the log is cleared.
    pub oldest: u64,
    /// Number after the newest row.
    pub end: u64,
    /// Entries in the log, visible or not.
    pub kept: u64,
    /// Entries dropped for newer ones since the log was cleared.
    pub gone: u64,
    /// Entries that are hidden because they are routine.
    pub collapsed: u64,
    /// How much of the log is filtered, in per mille; 1000 when done.
    pub filtered_per_mille: u16,
    /// Number of filter changes and clearings. It identifies answers to older requests.
    pub generation: u32,
    /// The requested rows that exist.
    pub rows: Vec<Row>,
}

/// One row of the log, as text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Row {
    /// Its number.
    pub number: u64,
    /// Its kind.
    pub kind: Kind,
    /// Local time of day, `13:15:36.962`.
    pub time: String,
    /// The motor that it concerns, `0x01`; may be empty.
    pub id: String,
    /// Its bytes; may be empty.
    pub hex: String,
    /// Its meaning.
    pub meaning: String,
    /// Number of hidden routine entries directly before it.
    pub collapsed_before: u32,
    /// Number of opened routine entries that begin with this row: see [`ToRecorder::Toggle`].
    pub opened: u32,
}

/// The state of the recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordingStatus {
    /// Whether samples are being added.
    pub recording: bool,
    /// Recorded samples since the last export.
    pub recorded: u64,
    /// Recorded time, in milliseconds.
    pub recorded_ms: u64,
    /// Whether the recording is full and has stopped by itself.
    pub full: bool,
    /// Whether all recorded samples were exported.
    pub exported: bool,
    /// Samples of the last ten minutes, which are always kept.
    pub rolling: u64,
}

/// Decodes the line events of the port worker, oldest first. Ends at the first invalid one.
pub fn traffic(bytes: &[u8]) -> impl Iterator<Item = LineEvent> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let (traffic, behind) = postcard::take_from_bytes(rest).ok()?;
        rest = behind;
        Some(traffic)
    })
}

/// Encodes one line event into a buffer for the recorder.
pub fn push_traffic(buffer: &mut Vec<u8>, traffic: &LineEvent) {
    // It always encodes, and the buffer grows.
    if let Ok(longer) = postcard::to_extend(traffic, std::mem::take(buffer)) {
        *buffer = longer;
    }
}
