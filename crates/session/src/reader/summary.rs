//! Reads the index at the end of a file.

use super::{CHUNKS_MAX, Problem, Session};
use crate::{
    channels::Topic,
    format,
    mcap::{
        CHUNK_BYTES_MAX, CRC, MAGIC, RECORD_HEAD_LEN,
        fields::Fields,
        op,
        summary::{AttachmentIndex, ChunkIndex, MetadataIndex},
    },
};

/// The last record.
#[derive(Clone, Copy, Debug)]
pub(super) struct Footer {
    pub(super) summary_start: u64,
}

impl Footer {
    /// Parses the last bytes of a file; `None` if they are not a footer.
    pub(super) fn read(tail: &[u8]) -> Option<Self> {
        let record = tail.strip_suffix(&MAGIC)?;
        let (opcode, content) = Fields(record).record()?;
        let summary_start = Fields(content).u64()?;
        (opcode == op::FOOTER).then_some(Self { summary_start })
    }
}

/// Reads the summary with its footer, which begins at `start`. Returns the position of the metadata; `None` if the
/// bytes are damaged.
pub(super) fn read_summary(
    bytes: &[u8],
    start: u64,
    session: &mut Session,
) -> Option<Vec<MetadataIndex>> {
    let (checked, crc) = bytes.split_last_chunk::<4>()?;
    let crc = u32::from_le_bytes(*crc);
    // Zero means that the writer computed none.
    if crc != 0 && crc != CRC.checksum(checked) {
        return None;
    }
    let mut metadata = Vec::new();
    let mut records = Fields(bytes);
    while let Some((opcode, content)) = records.record() {
        match opcode {
            op::CHANNEL => {
                session.has_channels = true;
                Topic::read_channel(&mut session.topics, content);
            }
            op::CHUNK_INDEX => session.add_chunk(ChunkIndex::read(content)?, start),
            op::ATTACHMENT_INDEX => session.add_attachment(AttachmentIndex::read(content)?),
            op::METADATA_INDEX => metadata.push(MetadataIndex::read(content)?),
            _ => {}
        }
    }
    // The order in the file is the order of the monotonic clock, even if the wall clock changed.
    session.chunks.sort_by_key(|chunk| chunk.offset);
    session.remove_overlapping_chunks();
    records.0.is_empty().then_some(metadata)
}

impl Session {
    /// Adds a chunk that ends before this offset. An impossible one is skipped.
    pub(super) fn add_chunk(&mut self, chunk: ChunkIndex, end: u64) {
        let ends = chunk.offset.checked_add(chunk.length);
        let fits = ends.is_some_and(|ends| ends <= end) && chunk.length <= 2 * CHUNK_BYTES_MAX;
        if !fits || chunk.size > CHUNK_BYTES_MAX {
            self.problems.add(Problem::ChunkDamaged);
        } else if self.chunks.len() >= CHUNKS_MAX {
            self.problems.add(Problem::TooManyChunks);
        } else {
            self.chunks.push(chunk);
        }
    }

    /// Removes chunks that overlap the one before. Otherwise a small file could name one chunk 200,000 times, and reading
    /// it would take hours.
    fn remove_overlapping_chunks(&mut self) {
        let mut end = 0;
        let mut removed = 0;
        self.chunks.retain(|chunk| {
            let follows = chunk.offset >= end && chunk.length > RECORD_HEAD_LEN;
            if follows {
                end = chunk.offset + chunk.length;
            } else {
                removed += 1;
            }
            follows
        });
        self.problems.add_all(Problem::ChunkDamaged, removed);
    }

    pub(super) fn add_attachment(&mut self, attachment: AttachmentIndex) {
        // A session has a few attachments. The bound protects against files with millions.
        if self.attachments.len() < CHUNKS_MAX {
            self.attachments.push(attachment);
        }
    }

    /// Records the problems of a scan. If a file has its end, but its records do not lead there, it is damaged in
    /// between.
    pub(super) fn record_problems(&mut self, is_whole: bool) {
        let has_end = self.problems.times(Problem::Cut) == 0;
        if has_end && !is_whole && self.problems.times(Problem::RecordDamaged) == 0 {
            self.problems.add(Problem::RecordDamaged);
        }
    }

    /// Takes a metadata record with its head.
    pub(super) fn read_metadata(&mut self, record: &[u8]) {
        let content = Fields(record).record().map(|(_, content)| content);
        let mut fields = Fields(content.unwrap_or_default());
        if fields.text() != Some(format::METADATA) {
            return;
        }
        self.about = fields.texts().unwrap_or_default().into_iter().collect();
        let version = self.about.get(format::VERSION_KEY);
        let version = version.and_then(|version| version.parse::<u32>().ok());
        if version.is_none_or(|version| version > format::VERSION) {
            self.problems.add(Problem::NewerVersion);
        }
    }
}
