//! Copies a session file with other bookmarks. Everything else of the file stays as it is.
//!
//! A bookmark is an event in the channel `/events`, in the order of the monotonic clock. Only chunks that have one, or
//! get one, are rewritten; every other record of the data is copied byte by byte, unknown ones too. Messages outside of
//! chunks become chunks, so that the copy has an index of them. The overview is replaced, because it has the bookmarks, and
//! the summary, because it has the places of all records.
//!
//! | file | what it holds |
//! |---|---|
//! | `bookmarks` | bookmarks, and those of an overview |
//! | `chunk` | the bookmarks in one chunk |

mod bookmarks;
mod chunk;

use std::{collections::BTreeMap, ops::Range};

use crc::Digest;

pub use bookmarks::BOOKMARK_TEXT_MAX;
use bookmarks::{Pending, sorted, with_bookmarks};
use chunk::{Chunk, Events};
use motorlink_messages::sessions::Bookmark;

use crate::{
    channels::Topic,
    format,
    mcap::{
        CHUNK_BYTES_MAX, CRC, MAGIC, RECORD_HEAD_LEN,
        fields::Fields,
        file_index::FileIndex,
        op,
        summary::{AttachmentIndex, ChunkIndex, MetadataIndex},
    },
    overview::Overview,
    reader::{Session, Source, decompressed},
};

/// Bytes per request, and at most per answer unless a chunk is larger.
const WINDOW: u64 = 1 << 20;

/// A record up to this length is copied in one go. Longer ones, such as large attachments, are copied in pieces.
const WHOLE_MAX: u64 = 2 * CHUNK_BYTES_MAX;

/// Attachments at which a copy continues behind damage. A file has fewer; a hostile one could have any number.
const ATTACHMENTS_MAX: usize = 1_000;

/// Copies a file part by part. The caller reads what it needs and appends what it returns.
pub struct Copying {
    len: u64,
    /// The next byte of the file that is not copied.
    at: u64,
    buffer: Vec<u8>,
    buffer_at: u64,
    /// End of a record that is copied in pieces.
    passing: Option<u64>,
    /// Whether the indexes of the previous chunk are left out, because it was rewritten.
    skips_indexes: bool,
    /// The chunks that the reader knows, in their order. Behind damage the copy continues at the next one, or at the next
    /// attachment.
    chunks: Vec<Known>,
    attachments: Vec<u64>,
    topics: BTreeMap<u16, Topic>,
    events: Events,
    pending: Pending,
    overview: Overview,
    index: FileIndex,
    written: u64,
    crc: Digest<'static, u32>,
    is_done: bool,
}

/// A chunk that the reader knows, or messages outside of chunks.
#[derive(Clone, Copy)]
struct Known {
    offset: u64,
    length: u64,
    is_loose: bool,
}

/// The next result of a copy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CopyStep {
    /// It needs these bytes: see [`Copying::supply`].
    Read(Range<u64>),
    /// The next bytes of the copy.
    Write(Vec<u8>),
    /// The copy is complete.
    Done,
}

impl std::fmt::Debug for Copying {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut f = f.debug_struct("Copying");
        f.field("at", &self.at).field("len", &self.len);
        f.finish_non_exhaustive()
    }
}

impl Copying {
    /// A copy of the file of `len` bytes with these bookmarks instead of its own.
    #[must_use]
    pub fn new(session: &Session, overview: &Overview, len: u64, bookmarks: &[Bookmark]) -> Self {
        let bookmarks = sorted(bookmarks);
        let first = overview.begins().unwrap_or_default();
        let chunks = session.chunk_indexes().iter().map(|chunk| Known {
            offset: chunk.offset,
            length: chunk.length,
            is_loose: chunk.is_loose,
        });
        let attachments = session.attachment_offsets().take(ATTACHMENTS_MAX);
        Self {
            len,
            at: 0,
            buffer: Vec::new(),
            buffer_at: 0,
            passing: None,
            skips_indexes: false,
            chunks: chunks.collect(),
            attachments: attachments.collect(),
            topics: session.topics().clone(),
            events: Events::of(session.topics()),
            pending: Pending::new(&bookmarks, first),
            overview: with_bookmarks(overview, &bookmarks),
            index: FileIndex::default(),
            written: 0,
            crc: CRC.digest(),
            is_done: false,
        }
    }

    /// The next byte of the file that is not copied.
    #[must_use]
    pub const fn at(&self) -> u64 {
        self.at
    }

    /// Takes the requested bytes. Fewer bytes mean that the file is shorter than it was.
    pub fn supply(&mut self, range: &Range<u64>, bytes: &[u8]) {
        self.buffer_at = range.start;
        self.buffer.clear();
        self.buffer.extend(bytes);
        if (bytes.len() as u64) < range.end - range.start {
            self.len = range.start + bytes.len() as u64;
        }
    }

    /// The next step.
    pub fn step(&mut self) -> CopyStep {
        if self.is_done {
            return CopyStep::Done;
        }
        let mut out = Vec::new();
        loop {
            if out.len() as u64 >= WINDOW {
                return self.write(out);
            }
            match self.advance(&mut out) {
                Advance::Copied => {}
                Advance::Needs(_) if !out.is_empty() => return self.write(out),
                Advance::Needs(range) => return CopyStep::Read(range),
                Advance::End => {
                    self.end(&mut out);
                    return self.write(out);
                }
            }
        }
    }

    fn write(&mut self, out: Vec<u8>) -> CopyStep {
        self.written += out.len() as u64;
        if !self.is_done {
            self.crc.update(&out);
        }
        CopyStep::Write(out)
    }

    /// The buffered bytes from here on, or the range to read for that many.
    fn have(&self, length: u64) -> Result<&[u8], Range<u64>> {
        let wanted = self.at..self.len.min(self.at.saturating_add(length));
        let from = self.at.checked_sub(self.buffer_at);
        let from = from.and_then(|from| usize::try_from(from).ok());
        let have = from.and_then(|from| self.buffer.get(from..));
        match have {
            Some(have) if have.len() as u64 >= wanted.end - wanted.start => Ok(have),
            _ => Err(wanted.start..wanted.end.max(self.len.min(self.at + WINDOW))),
        }
    }

    fn advance(&mut self, out: &mut Vec<u8>) -> Advance {
        if let Some(end) = self.passing {
            return self.pass(end, out);
        }
        if self.at == 0 {
            return match self.have(MAGIC.len() as u64) {
                Ok(_) => self.pass(MAGIC.len() as u64, out),
                Err(range) => Advance::Needs(range),
            };
        }
        let at = self.at;
        let place = self.chunks.partition_point(|chunk| chunk.offset < at);
        let chunk = self.chunks.get(place).copied();
        if let Some(chunk) = chunk.filter(|chunk| chunk.offset == at) {
            return self.known_chunk(chunk, out);
        }
        let have = match self.have(RECORD_HEAD_LEN) {
            Ok(have) => have,
            Err(range) => return Advance::Needs(range),
        };
        let mut fields = Fields(have);
        let (Some(opcode), Some(length)) = (fields.u8(), fields.u64()) else {
            return Advance::End;
        };
        let ends = self.at.checked_add(RECORD_HEAD_LEN);
        let ends = ends.and_then(|at| at.checked_add(length));
        // A record that reaches into a known one, or ends the data before it, is damaged.
        let attachments = self.attachments.iter().copied();
        let next = attachments.filter(|offset| *offset > at);
        let next = next.chain(chunk.map(|chunk| chunk.offset)).min();
        let limit = next.unwrap_or(self.len).min(self.len);
        let is_end = matches!(opcode, op::DATA_END | op::FOOTER);
        let is_damaged = opcode == 0 || is_end && next.is_some();
        let Some(end) = ends.filter(|end| *end <= limit && !is_damaged) else {
            return next.map_or(Advance::End, |next| self.pass(next, out));
        };
        if is_end {
            return Advance::End;
        }
        // Of a longer one the head is enough.
        let whole = (end - self.at).min(WHOLE_MAX);
        let record = match self.have(whole) {
            Ok(have) => have.get(..usize::try_from(whole).unwrap_or_default()),
            Err(range) => return Advance::Needs(range),
        };
        let record = record.unwrap_or_default().to_vec();
        if whole < end - self.at {
            self.note(opcode, &record, end - self.at, out);
            return self.pass(end, out);
        }
        self.at = end;
        self.record(opcode, &record, out);
        Advance::Copied
    }

    /// Copies bytes up to this end as they are.
    fn pass(&mut self, end: u64, out: &mut Vec<u8>) -> Advance {
        let length = (end - self.at).min(WINDOW);
        let piece = match self.have(length) {
            Ok(have) => have.get(..usize::try_from(length).unwrap_or_default()),
            Err(range) => {
                self.passing = Some(end);
                return Advance::Needs(range);
            }
        };
        let piece = piece.unwrap_or_default();
        if piece.is_empty() {
            return Advance::End;
        }
        out.extend(piece);
        self.at += piece.len() as u64;
        self.passing = (self.at < end).then_some(end);
        Advance::Copied
    }

    /// Copies a chunk by its length in the index. The length in its head may be damaged.
    fn known_chunk(&mut self, chunk: Known, out: &mut Vec<u8>) -> Advance {
        let length = chunk.length;
        let bytes = match self.have(length) {
            Ok(have) => have.get(..usize::try_from(length).unwrap_or_default()),
            Err(range) => return Advance::Needs(range),
        };
        let bytes = bytes.unwrap_or_default().to_vec();
        if (bytes.len() as u64) < length {
            return Advance::End;
        }
        self.at += length;
        let mut records = Fields(&bytes);
        if chunk.is_loose {
            let chunk = self.chunk(&bytes);
            self.put_chunk(&chunk, out);
        } else if matches!(records.record(), Some((op::CHUNK, _)) if records.0.is_empty()) {
            self.record(op::CHUNK, &bytes, out);
        } else {
            out.extend(bytes);
        }
        Advance::Copied
    }

    fn record(&mut self, opcode: u8, whole: &[u8], out: &mut Vec<u8>) {
        if opcode == op::MESSAGE_INDEX && self.skips_indexes {
            return;
        }
        self.skips_indexes &= opcode == op::MESSAGE_INDEX;
        if opcode == op::CHUNK {
            if let Ok(raw) = decompressed(whole) {
                let chunk = self.chunk(&raw);
                self.skips_indexes = chunk.is_changed;
                if chunk.is_changed {
                    return self.put_chunk(&chunk, out);
                }
            }
        } else if opcode == op::ATTACHMENT {
            let content = whole.get(HEAD..).unwrap_or_default();
            let index = AttachmentIndex::of_attachment(0, 0, content);
            // The new one follows at the end.
            if index.is_some_and(|index| index.name == format::OVERVIEW) {
                return;
            }
        }
        self.note(opcode, whole, whole.len() as u64, out);
        out.extend(whole);
    }

    /// A chunk of these records, with the bookmarks.
    fn chunk(&mut self, raw: &[u8]) -> Chunk {
        let chunk = Chunk::copy(raw, &mut self.topics, &self.events, &mut self.pending);
        for (opcode, id, content) in &chunk.declared {
            let known = self.index.declared(*opcode);
            known.insert(*id, content.clone());
        }
        self.index.count(&chunk.open.indexes);
        chunk
    }

    fn put_chunk(&mut self, chunk: &Chunk, out: &mut Vec<u8>) {
        let index = chunk.open.put(out, self.written);
        self.index.chunks.extend(index);
    }

    /// Takes a record that is copied as it is into the new summary. Of a long one only the beginning is there.
    fn note(&mut self, opcode: u8, begin: &[u8], length: u64, out: &[u8]) {
        let offset = self.written + out.len() as u64;
        let content = begin.get(HEAD..).unwrap_or_default();
        let content_length = length.saturating_sub(RECORD_HEAD_LEN);
        let mut fields = Fields(content);
        match opcode {
            op::SCHEMA | op::CHANNEL => {
                if let Some(id) = fields.u16() {
                    let known = self.index.declared(opcode);
                    known.insert(id, content.to_vec());
                }
                self.events.see(opcode, content);
            }
            op::CHUNK => {
                let index = ChunkIndex::of_chunk(offset, content_length, content);
                self.index.chunks.extend(index);
            }
            op::MESSAGE_INDEX => {
                if let (Some(chunk), Some(channel)) = (self.index.chunks.last_mut(), fields.u16()) {
                    chunk.message_indexes.push((channel, offset));
                    chunk.index_length += length;
                }
            }
            op::MESSAGE => {
                if let Some(channel) = fields.u16() {
                    *self.index.messages.entry(channel).or_default() += 1;
                }
            }
            op::ATTACHMENT => {
                let index = AttachmentIndex::of_attachment(offset, content_length, content);
                self.index.attachments.extend(index);
            }
            op::METADATA => {
                if let Some(name) = fields.text() {
                    self.index.metadata.push(MetadataIndex {
                        offset,
                        length,
                        name: name.to_owned(),
                    });
                }
            }
            _ => {}
        }
    }

    /// The bookmarks behind the last chunk, the overview and the summary.
    fn end(&mut self, out: &mut Vec<u8>) {
        self.is_done = true;
        let rest = Chunk::of_rest(&self.events, &mut self.pending);
        for (opcode, id, content) in &rest.declared {
            let known = self.index.declared(*opcode).entry(*id);
            known.or_insert_with(|| content.clone());
        }
        self.index.count(&rest.open.indexes);
        self.put_chunk(&rest, out);
        let json = self.overview.to_json();
        let log_ns = self.overview.span_ns().map_or(0, |(_, to)| to);
        let name = (format::OVERVIEW, "application/json");
        self.index
            .attach(out, self.written, log_ns, name, json.as_bytes());
        self.crc.update(out);
        let crc = self.crc.clone().finalize();
        let data_len = self.written + out.len() as u64;
        let end = self.index.end(data_len, crc);
        out.extend(end);
    }
}

/// Copies a file, and passes the bytes of the copy to `write`.
///
/// # Errors
/// Those of the source.
pub fn copy<S: Source>(
    source: &mut S,
    session: &Session,
    overview: &Overview,
    bookmarks: &[Bookmark],
    mut write: impl FnMut(&[u8]),
) -> Result<(), S::Error> {
    let mut copying = Copying::new(session, overview, source.len(), bookmarks);
    loop {
        match copying.step() {
            CopyStep::Read(range) => {
                let bytes = source.read(range.clone())?;
                copying.supply(&range, &bytes);
            }
            CopyStep::Write(bytes) => write(&bytes),
            CopyStep::Done => return Ok(()),
        }
    }
}

/// Bytes of a record before its content.
const HEAD: usize = 9;

enum Advance {
    Copied,
    /// Bytes of the file.
    Needs(Range<u64>),
    /// The data ends here, or nothing more of it can be read.
    End,
}
