//! What crosses between the page and the recorder, the second worker, which keeps the packet log and
//! the recording.
//!
//! Frames do not come to it through the page: the worker that owns the port posts them right into the
//! recorder's line, as [`LineEvent`] one behind the other, each encoded as by
//! [`encode`](crate::encode).

use motorlink_bus::{LineEvent, Sample};
use motorlink_protocol::{Instant, MotorId};
use serde::{Deserialize, Serialize};

/// From the page to the recorder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToRecorder {
    /// The wall clock at the zero of every [`Instant`]: the other worker's `performance.timeOrigin`,
    /// in milliseconds since 1970.
    Epoch {
        /// In milliseconds since 1970, UTC.
        unix_ms: f64,
    },
    /// A line of the page's own.
    Say {
        /// When.
        at: Instant,
        /// Whether something went wrong.
        error: bool,
        /// In words, one line.
        text: String,
    },
    /// Which rows of the packet log are to be seen. Answered by a [`LogPage`], and by another whenever
    /// one of these rows, or a count, changes; at most 30 times a second.
    Look(Window),
    /// Put entries into words in this language from now on, `en`, `zh` or `de`: those that are seen, and
    /// those in which is searched. Files say frames in English, and what the page said as it was said. The
    /// rows are numbered anew.
    Speak {
        /// The two letters of the language.
        language: String,
        /// The file of its texts, unless they are in the recorder's program.
        texts: Option<String>,
    },
    /// Which entries the log shows. The rows are numbered anew.
    Filter(Filter),
    /// Forget every entry of the log. The recording stays.
    Clear,
    /// Make a CSV file of every entry that is kept, shown or not.
    ExportLog,
    /// Make a CSV file of the recording, or of the last ten minutes where nothing was recorded.
    ExportTelemetry,
    /// Make no file after all.
    CancelExport,
    /// Begin or end the recording. It goes on where it was until it has been exported.
    Record(bool),
    /// Take in the session that was offered: its entries and samples stand before those of this one.
    Restore,
    /// Remove the session that was offered.
    Forget,
    /// Remove everything that is kept, and forget the log and the recording. The rows are numbered anew.
    Erase,
}

/// Rows to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Window {
    /// Number of the first row; `None` is the newest `rows` rows.
    pub first: Option<u64>,
    /// How many, at most [`Window::ROWS_MAX`].
    pub rows: u16,
}

impl Window {
    /// Five screens full.
    pub const ROWS_MAX: u16 = 400;
}

/// Which entries the log shows. An entry is shown that satisfies all of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Filter {
    /// Found, in any case of letters, in a row's time, ID, hex or meaning. Empty is everything.
    pub text: String,
    /// Of or to this motor.
    pub id: Option<MotorId>,
    /// Of this kind.
    pub kind: Option<Kind>,
    /// Without routine exchanges: feedback queries, unchanged drive frames, and their good replies.
    pub collapse: bool,
}

/// What an entry is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// A frame of ours.
    Tx,
    /// A good frame of a motor.
    Rx,
    /// Something that the page said.
    System,
    /// Something that went wrong: spoilt bytes, silence, and what the page said of it.
    Error,
}

/// From the recorder to the page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromRecorder {
    /// Rows of the log and its counts.
    Log(LogPage),
    /// The state of the recording; sent when it changes, at most five times a second.
    Recording(RecordingStatus),
    /// How far an export is; the last one, with a file, comes as [`FromRecorder::Exported`].
    Exporting {
        /// Which.
        what: Export,
        /// Rows written.
        done: u64,
        /// Rows in all.
        of: u64,
    },
    /// A file is ready. With this message comes a `Blob`.
    Exported {
        /// Which.
        what: Export,
        /// The name that the file is to have.
        name: String,
        /// Its rows, without the head.
        rows: u64,
    },
    /// No file was made: there was nothing to write, or it was cancelled.
    NotExported {
        /// Which.
        what: Export,
        /// Whether a person cancelled it.
        cancelled: bool,
    },
    /// The browser keeps a session that ended; offered until it is restored or forgotten.
    Kept(KeptSession),
    /// The session that was offered stands in log and recording. The rows are numbered anew.
    Restored,
    /// Samples of the session that was restored, of the last ten minutes of the recording: oldest first, at
    /// most [`PAST_SAMPLES_MAX`] at once. They come behind [`FromRecorder::Restored`], the newest first of
    /// all.
    Past {
        /// How much later the zero of their times is than that of every other [`Instant`], in microseconds:
        /// mostly it is earlier.
        zero_us: i64,
        /// The samples.
        samples: Vec<Sample>,
    },
    /// Everything that was kept has been removed.
    Erased {
        /// Whether nothing is left; what other tabs have open is.
        all: bool,
    },
    /// From now on nothing is kept, and why; the log and the recording go on in memory.
    NotKept(NotKept),
    /// The recorder has failed; the log and the recording are lost.
    Died,
}

/// Samples of the past in one message: the page takes them in within a few milliseconds.
pub const PAST_SAMPLES_MAX: u16 = 2_000;

/// A session that the browser keeps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptSession {
    /// When the first of it happened, in milliseconds since 1970, UTC.
    pub from_ms: f64,
    /// When the last of it happened.
    pub to_ms: f64,
    /// Entries of the log that passed on the line.
    pub packets: u64,
    /// Samples that were recorded.
    pub recorded: u64,
    /// Time that was recorded, in milliseconds.
    pub recorded_ms: u64,
}

/// Why the browser keeps no copy of the session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotKept {
    /// The browser has no room for it.
    NoRoom,
    /// Its storage fails.
    Failed,
}

/// Which file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Export {
    /// Of the packet log.
    Log,
    /// Of the telemetry.
    Telemetry,
}

/// Rows of the log and its counts.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogPage {
    /// Number of the oldest row that can be shown. It grows when old entries give way; a row keeps its
    /// number until the filter changes or the log is cleared.
    pub oldest: u64,
    /// Number behind that of the newest row.
    pub end: u64,
    /// Entries that are kept, shown or not.
    pub kept: u64,
    /// Entries that gave way to newer ones, since the log was cleared.
    pub gone: u64,
    /// Entries that are kept and not shown because they are routine.
    pub collapsed: u64,
    /// How much of the log the filter has looked at, in per mille; 1000 when it is through.
    pub looked_at_per_mille: u16,
    /// Counts the changes of filter and the clearings, so that an answer to an older look can be told.
    pub generation: u32,
    /// The rows that were asked for, as far as there are any.
    pub rows: Vec<Row>,
}

/// One row of the log, in words.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Row {
    /// Its number.
    pub number: u64,
    /// What it is.
    pub kind: Kind,
    /// Local time of day, `13:15:36.962`.
    pub time: String,
    /// Whom it concerns, `0x01`; empty where that is nobody.
    pub id: String,
    /// Its bytes; empty where it has none.
    pub hex: String,
    /// What it says.
    pub meaning: String,
    /// Routine entries right before it that are not shown.
    pub collapsed_before: u32,
}

/// The state of the recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordingStatus {
    /// Whether samples are being added.
    pub recording: bool,
    /// Samples recorded since Record was pressed first, or since the last export.
    pub recorded: u64,
    /// Time that was recorded, in milliseconds.
    pub recorded_ms: u64,
    /// Whether the recording is full, and so ended by itself.
    pub full: bool,
    /// Whether the recording was exported as it is.
    pub exported: bool,
    /// Samples of the last ten minutes, which are always kept.
    pub rolling: u64,
}

/// The traffic in a buffer that came from the other worker, oldest first. What does not read ends it.
pub fn traffic(bytes: &[u8]) -> impl Iterator<Item = LineEvent> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let (traffic, behind) = postcard::take_from_bytes(rest).ok()?;
        rest = behind;
        Some(traffic)
    })
}

/// Adds one entry to a buffer that goes to the recorder.
pub fn push_traffic(buffer: &mut Vec<u8>, traffic: &LineEvent) {
    // It always encodes, and the buffer grows.
    if let Ok(longer) = postcard::to_extend(traffic, std::mem::take(buffer)) {
        *buffer = longer;
    }
}
