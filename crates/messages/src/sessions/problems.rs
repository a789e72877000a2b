//! What can be wrong with a session file.

use serde::{Deserialize, Serialize};

/// Why a file is not a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
pub enum NotASession {
    /// The file is empty.
    #[error("The file is empty. Choose another file.")]
    Empty,
    /// It is a ZIP archive.
    #[error("This is a ZIP archive. Unpack it, then open the file that was in it.")]
    Zip,
    /// It is an MCAP file of a later major version.
    #[error("This MCAP file has a later version of the format. Update MotorLink to open it.")]
    NewerContainer,
    /// It is a text: it may be a CSV file, see `Import` in `motorlink-session`.
    #[error(
        "This text file has no columns of a known export. Choose a session (.mcap) or a CSV file of MotorLink."
    )]
    Text,
    /// It is something else.
    #[error("Not a session file. Choose a session (.mcap) or a CSV file of MotorLink.")]
    Other,
}

/// One kind of problem. All readable parts are returned nevertheless.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, thiserror::Error,
)]
pub enum Problem {
    /// The file was written by a later version of the page.
    #[error(
        "A later version of MotorLink wrote this file. What this version does not know is left out. Update MotorLink to see it."
    )]
    NewerVersion,
    /// The file has no channel of a session.
    #[error("This MCAP file has no channel of MotorLink. Open it in Foxglove instead.")]
    NoSession,
    /// The end is missing: the file was not closed, or truncated.
    #[error("The end of the file is missing. Everything before it was read.")]
    Cut,
    /// The index at the end is damaged.
    #[error(
        "The index at the end of the file is damaged. The file was read from its start instead."
    )]
    IndexDamaged,
    /// Bytes that are not a record: everything after them is unknown.
    #[error(
        "The file is damaged in the middle, and its index is missing. What lies behind the damage could not be read."
    )]
    RecordDamaged,
    /// There are more chunks than can be read.
    #[error("The file has more parts than can be read. Only the first ones were read.")]
    TooManyChunks,
    /// A chunk is damaged.
    #[error("A part of the file is damaged and was left out.")]
    ChunkDamaged,
    /// A chunk has an unsupported compression, such as zstd.
    #[error(
        "A part of the file has a compression that MotorLink does not read. Convert the file with: mcap compress --compression lz4"
    )]
    CompressionUnknown,
    /// A message could not be read.
    #[error("A message could not be read and was left out.")]
    MessageDamaged,
    /// An attachment is damaged.
    #[error("An attached file is damaged and was left out.")]
    AttachmentDamaged,
    /// A line of a CSV file could not be read.
    #[error("A line of the CSV file could not be read and was left out.")]
    LineDamaged,
    /// The times of a CSV file have no date, so they begin in 1970.
    #[error("The file has times of day without a date. They are shown as of 1 January 1970.")]
    NoDate,
    /// The time of a line of a CSV file could not be read, or has no date unlike the first one.
    #[error(
        "The time of a line of the CSV file could not be read, or has no date, and the line was left out. A spreadsheet program can change times: open the file as it was exported."
    )]
    TimeLost,
}
