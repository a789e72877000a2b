//! What can be wrong with a session file.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Why a file is not a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotASession {
    /// The file is empty.
    Empty,
    /// It is a ZIP archive.
    Zip,
    /// It is an MCAP file of a later major version.
    NewerContainer,
    /// It is a text: it may be a CSV file, see `Import` in `motorlink-session`.
    Text,
    /// It is something else.
    Other,
}

impl fmt::Display for NotASession {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Empty => "The file is empty. Choose another file.",
            Self::Zip => "This is a ZIP archive. Unpack it, then open the file that was in it.",
            Self::NewerContainer => {
                "This MCAP file has a later version of the format. Update MotorLink to open it."
            }
            Self::Text => {
                "This text file has no columns of a known export. Choose a session (.mcap) or a CSV file of MotorLink."
            }
            Self::Other => {
                "This is no session. Choose a session (.mcap) or a CSV file of MotorLink."
            }
        })
    }
}

impl std::error::Error for NotASession {}

/// One kind of problem. All readable parts are returned nevertheless.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Problem {
    /// The file was written by a later version of the page.
    NewerVersion,
    /// The file has no channel of a session.
    NoSession,
    /// The end is missing: the file was not closed, or truncated.
    Cut,
    /// The index at the end is damaged.
    IndexDamaged,
    /// Bytes that are not a record: everything after them is unknown.
    RecordDamaged,
    /// There are more chunks than can be read.
    TooManyChunks,
    /// A chunk is damaged.
    ChunkDamaged,
    /// A chunk has an unsupported compression, such as zstd.
    CompressionUnknown,
    /// A message could not be read.
    MessageDamaged,
    /// An attachment is damaged.
    AttachmentDamaged,
    /// A line of a CSV file could not be read.
    LineDamaged,
    /// The times of a CSV file have no date, so they begin in 1970.
    NoDate,
    /// The time of a line of a CSV file could not be read, or has no date unlike the first one.
    TimeLost,
}

/// A text with a hint what to do, if something can be done.
impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NewerVersion => {
                "A later version of MotorLink wrote this file. What this version does not know is left out. Update MotorLink to see it."
            }
            Self::NoSession => {
                "This MCAP file has no channel of MotorLink. Open it in Foxglove instead."
            }
            Self::Cut => "The end of the file is missing. Everything before it was read.",
            Self::IndexDamaged => {
                "The index at the end of the file is damaged. The file was read from its start instead."
            }
            Self::RecordDamaged => {
                "The file is damaged in the middle, and its index is missing. What lies behind the damage could not be read."
            }
            Self::TooManyChunks => {
                "The file has more parts than can be read. Only the first ones were read."
            }
            Self::ChunkDamaged => "A part of the file is damaged and was left out.",
            Self::CompressionUnknown => {
                "A part of the file has a compression that MotorLink does not read. Convert the file with: mcap compress --compression lz4"
            }
            Self::MessageDamaged => "A message could not be read and was left out.",
            Self::AttachmentDamaged => "An attached file is damaged and was left out.",
            Self::LineDamaged => "A line of the CSV file could not be read and was left out.",
            Self::NoDate => "The file has times of day without a date. They are shown as of 1 January 1970.",
            Self::TimeLost => {
                "The time of a line of the CSV file could not be read, or has no date, and the line was left out. A spreadsheet program can change times: open the file as it was exported."
            }
        })
    }
}
