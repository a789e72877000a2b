//! Rebuilds the index of a file whose end is missing: it reads the heads of all records from the start.

use std::ops::Range;

use super::{Problem, Session};
use crate::mcap::{
    MAGIC, RECORD_HEAD_LEN,
    fields::Fields,
    op,
    summary::{AttachmentIndex, ChunkHead, ChunkIndex},
};

/// Bytes per request. They contain the whole head of a record.
const WINDOW: u64 = 64 << 10;

/// The progress of a scan.
#[derive(Debug)]
pub(super) struct Scan {
    at: u64,
    /// Whether the end of the data was reached, after which the summary begins.
    pub(super) is_whole: bool,
}

impl Default for Scan {
    fn default() -> Self {
        Self {
            at: MAGIC.len() as u64,
            is_whole: false,
        }
    }
}

/// The result of one record.
enum Found {
    /// The next record begins here.
    Next(u64),
    /// More bytes from here are needed.
    More,
    /// Nothing more can be read.
    End,
    /// The data ends here.
    DataEnd,
}

impl Scan {
    /// The place of the next record.
    pub(super) const fn at(&self) -> u64 {
        self.at
    }

    pub(super) fn range(&self, len: u64) -> Range<u64> {
        let from = self.at.min(len);
        from..from.saturating_add(WINDOW).min(len)
    }

    /// Takes the bytes of [`Self::range`]. Returns whether the scan is complete.
    pub(super) fn supply(&mut self, len: u64, bytes: &[u8], session: &mut Session) -> bool {
        let start = self.at;
        if bytes.is_empty() {
            return true;
        }
        loop {
            let skipped = usize::try_from(self.at - start).unwrap_or(usize::MAX);
            let Some(window) = bytes.get(skipped..).filter(|window| !window.is_empty()) else {
                return self.at >= len;
            };
            // A window that begins at the record contains all of its head.
            let has_head = skipped == 0 || self.at + window.len() as u64 >= len;
            match record(self.at, len, window, session) {
                Found::Next(at) => self.at = at,
                Found::More if has_head => return true,
                Found::More => return false,
                Found::End => return true,
                Found::DataEnd => {
                    self.is_whole = true;
                    return true;
                }
            }
        }
    }
}

fn record(at: u64, len: u64, window: &[u8], session: &mut Session) -> Found {
    let mut fields = Fields(window);
    let (Some(opcode), Some(length)) = (fields.u8(), fields.u64()) else {
        return Found::More;
    };
    let known = op::HEADER..=op::DATA_END;
    if !known.contains(&opcode) {
        session.problems.add(Problem::RecordDamaged);
        return Found::End;
    }
    let end = at
        .checked_add(RECORD_HEAD_LEN)
        .and_then(|at| at.checked_add(length));
    let Some(end) = end.filter(|end| *end <= len) else {
        // The file is truncated in this record, or its length is damaged.
        return Found::End;
    };
    let is_near = |bytes: u64| fields.0.len() as u64 >= bytes.min(length);
    match opcode {
        op::CHUNK => {
            if !is_near(ChunkHead::LEN_MAX) {
                return Found::More;
            }
            match ChunkIndex::of_chunk(at, length, fields.0) {
                Some(chunk) => session.add_chunk(chunk, len),
                None => session.problems.add(Problem::ChunkDamaged),
            }
        }
        op::ATTACHMENT => {
            if !is_near(WINDOW / 2) {
                return Found::More;
            }
            if let Some(attachment) = AttachmentIndex::of_attachment(at, length, fields.0) {
                session.add_attachment(attachment);
            }
        }
        op::CHANNEL | op::METADATA => {
            if !is_near(WINDOW / 2) {
                return Found::More;
            }
            if opcode == op::METADATA {
                session.read_metadata(window);
            } else {
                session.read_channel(fields.0);
            }
        }
        // The summary follows, which was found damaged.
        op::DATA_END => return Found::DataEnd,
        _ => {}
    }
    Found::Next(end)
}
