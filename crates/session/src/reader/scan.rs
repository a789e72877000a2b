//! Makes the index of a file that has none, such as one whose end is missing: it reads the heads of all records from the
//! start.

use std::ops::Range;

use super::{Problem, Session};
use crate::{
    channels::Topic,
    mcap::{
        MAGIC, RECORD_HEAD_LEN,
        fields::Fields,
        op,
        summary::{AttachmentIndex, ChunkHead, ChunkIndex},
    },
};

/// Bytes per request. They contain the whole head of a record.
const WINDOW: u64 = 64 << 10;

/// Bytes of messages outside of chunks that are read at once, unless one is longer.
const LOOSE_MAX: u64 = 512 << 10;

/// The progress of a scan.
#[derive(Debug)]
pub(super) struct Scan {
    at: u64,
    /// The opcode of the record before.
    before: u8,
    /// Messages outside of chunks, up to here.
    loose: Option<ChunkIndex>,
    /// Whether the end of the data was reached, after which the summary begins.
    pub(super) is_whole: bool,
}

impl Default for Scan {
    fn default() -> Self {
        Self {
            at: MAGIC.len() as u64,
            before: op::HEADER,
            loose: None,
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
        let is_complete = self.read(len, bytes, session);
        if is_complete {
            self.end_loose(len, session);
        }
        is_complete
    }

    fn read(&mut self, len: u64, bytes: &[u8], session: &mut Session) -> bool {
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
            match self.record(len, window, session) {
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

    fn record(&mut self, len: u64, window: &[u8], session: &mut Session) -> Found {
        let at = self.at;
        let mut fields = Fields(window);
        let (Some(opcode), Some(length)) = (fields.u8(), fields.u64()) else {
            return Found::More;
        };
        let end = at
            .checked_add(RECORD_HEAD_LEN)
            .and_then(|at| at.checked_add(length));
        let Some(end) = end.filter(|end| *end <= len && opcode != 0) else {
            // The file is truncated in this record, or its head is damaged.
            if !(op::HEADER..=op::DATA_END).contains(&opcode) {
                session.problems.add(Problem::RecordDamaged);
            }
            return Found::End;
        };
        let is_near = |bytes: u64| fields.0.len() as u64 >= bytes.min(length);
        let needed = match opcode {
            op::CHUNK | op::MESSAGE => ChunkHead::LEN_MAX,
            op::ATTACHMENT | op::CHANNEL | op::METADATA => WINDOW / 2,
            // Others are skipped, also those that this version does not know.
            _ => 0,
        };
        if !is_near(needed) {
            return Found::More;
        }
        if opcode != op::MESSAGE {
            self.end_loose(len, session);
        }
        match opcode {
            op::CHUNK => match ChunkIndex::of_chunk(at, length, fields.0) {
                Some(chunk) => session.add_chunk(chunk, len),
                None => session.problems.add(Problem::ChunkDamaged),
            },
            op::MESSAGE => self.add_loose(end - at, fields, len, session),
            // What was before it should be a chunk.
            op::MESSAGE_INDEX if !matches!(self.before, op::CHUNK | op::MESSAGE_INDEX) => {
                session.problems.add(Problem::ChunkDamaged);
            }
            op::ATTACHMENT => {
                if let Some(attachment) = AttachmentIndex::of_attachment(at, length, fields.0) {
                    session.add_attachment(attachment);
                }
            }
            op::METADATA => session.read_metadata(window),
            op::CHANNEL => Topic::read_channel(&mut session.topics, fields.0),
            // A summary follows, which is missing or damaged.
            op::DATA_END => return Found::DataEnd,
            _ => {}
        }
        self.before = opcode;
        Found::Next(end)
    }

    /// Takes a message outside of chunks.
    fn add_loose(&mut self, length: u64, mut content: Fields<'_>, len: u64, session: &mut Session) {
        let log_ns = content.u16().and(content.u32()).and(content.u64());
        let Some(log_ns) = log_ns else {
            return session.problems.add(Problem::MessageDamaged);
        };
        let is_full = |loose: &ChunkIndex| loose.length.saturating_add(length) > LOOSE_MAX;
        if self.loose.as_ref().is_some_and(is_full) {
            self.end_loose(len, session);
        }
        let at = self.at;
        let loose = self
            .loose
            .get_or_insert_with(|| ChunkIndex::of_loose(at, log_ns));
        loose.add_loose(length, log_ns);
    }

    fn end_loose(&mut self, len: u64, session: &mut Session) {
        if let Some(loose) = self.loose.take() {
            session.add_chunk(loose, len);
        }
    }
}
