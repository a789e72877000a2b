//! The writer of the container: takes messages, and returns bytes when they are complete.

use std::collections::BTreeMap;

use crc::Digest;

use super::{
    CRC, MAGIC,
    compression::{self, LZ4},
    op,
    put::{self, record},
    summary::{AttachmentIndex, ChunkIndex, MetadataIndex},
};

/// Bytes per chunk before compression: six seconds of 500 exchanges a second. A seek decompresses one chunk, in 1 ms.
/// Chunks of twice the size make the file 2 % smaller.
const CHUNK_BYTES: usize = 512 << 10;

/// Maximal time per chunk, so that a truncated file loses no more.
const CHUNK_NS: u64 = 10_000_000_000;

/// A registered channel.
#[derive(Debug)]
struct Channel {
    schema: u16,
    topic: String,
    messages: u64,
}

/// Writes the container.
#[derive(Debug)]
pub(crate) struct Container {
    out: Vec<u8>,
    /// Number of bytes that were taken before those in `out`.
    taken: u64,
    /// The CRC of everything before `out`.
    crc: DataCrc,
    chunk: Chunk,
    schemas: Vec<(&'static str, &'static str)>,
    channels: Vec<Channel>,
    chunks: Vec<ChunkIndex>,
    attachments: Vec<AttachmentIndex>,
    metadata: Vec<MetadataIndex>,
}

/// A CRC of bytes that were taken already.
struct DataCrc(Digest<'static, u32>);

impl std::fmt::Debug for DataCrc {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("DataCrc")
    }
}

/// The chunk being filled.
#[derive(Debug, Default)]
struct Chunk {
    raw: Vec<u8>,
    times: Option<(u64, u64)>,
    /// By channel: time and offset of each message.
    indexes: BTreeMap<u16, Vec<(u64, u64)>>,
}

impl Container {
    pub(crate) fn new(profile: &str, library: &str) -> Self {
        let mut out = MAGIC.to_vec();
        record(&mut out, op::HEADER, |out| {
            put::text(out, profile);
            put::text(out, library);
        });
        Self {
            out,
            taken: 0,
            crc: DataCrc(CRC.digest()),
            chunk: Chunk::default(),
            schemas: Vec::new(),
            channels: Vec::new(),
            chunks: Vec::new(),
            attachments: Vec::new(),
            metadata: Vec::new(),
        }
    }

    /// Registers a JSON schema. Returns its ID.
    pub(crate) fn schema(&mut self, name: &'static str, json: &'static str) -> u16 {
        self.schemas.push((name, json));
        let id = u16::try_from(self.schemas.len()).unwrap_or(u16::MAX);
        put_schema(&mut self.chunk.raw, id, (name, json));
        id
    }

    /// Registers a channel. Returns its ID.
    pub(crate) fn channel(&mut self, schema: u16, topic: String) -> u16 {
        let id = u16::try_from(self.channels.len() + 1).unwrap_or(u16::MAX);
        put_channel(&mut self.chunk.raw, id, schema, &topic);
        self.channels.push(Channel {
            schema,
            topic,
            messages: 0,
        });
        id
    }

    /// Adds a message to the chunk being filled.
    pub(crate) fn message(&mut self, channel: u16, log_ns: u64, data: &[u8]) {
        let since = self
            .chunk
            .times
            .map_or(0, |(from, _)| log_ns.abs_diff(from));
        if self.chunk.raw.len() >= CHUNK_BYTES || since >= CHUNK_NS {
            self.end_chunk();
        }
        let Some(known) = self.channels.get_mut(usize::from(channel.wrapping_sub(1))) else {
            return;
        };
        let sequence = u32::try_from(known.messages & u64::from(u32::MAX)).unwrap_or_default();
        known.messages += 1;
        let chunk = &mut self.chunk;
        let offset = chunk.raw.len() as u64;
        record(&mut chunk.raw, op::MESSAGE, |out| {
            put::u16(out, channel);
            put::u32(out, sequence);
            put::u64(out, log_ns);
            put::u64(out, log_ns);
            out.extend(data);
        });
        let (from, to) = chunk.times.unwrap_or((log_ns, log_ns));
        chunk.times = Some((from.min(log_ns), to.max(log_ns)));
        let index = chunk.indexes.entry(channel).or_default();
        index.push((log_ns, offset));
    }

    /// Writes the chunk being filled. Each chunk contains its channels again, so that it can be read if others are
    /// damaged.
    pub(crate) fn end_chunk(&mut self) {
        let chunk = std::mem::take(&mut self.chunk);
        let Some((from_ns, to_ns)) = chunk.times else {
            self.chunk = chunk;
            return;
        };
        let offset = self.offset();
        let compressed = compression::compress(&chunk.raw);
        let raw_size = chunk.raw.len() as u64;
        record(&mut self.out, op::CHUNK, |out| {
            put::u64(out, from_ns);
            put::u64(out, to_ns);
            put::u64(out, raw_size);
            put::u32(out, CRC.checksum(&chunk.raw));
            put::text(out, LZ4);
            put::u64(out, compressed.len() as u64);
            out.extend(&compressed);
        });
        let index_offset = self.offset();
        let mut message_indexes = Vec::new();
        for (channel, messages) in &chunk.indexes {
            message_indexes.push((*channel, self.offset()));
            record(&mut self.out, op::MESSAGE_INDEX, |out| {
                put::u16(out, *channel);
                put::sized(out, |out| {
                    for (time, offset) in messages {
                        put::u64(out, *time);
                        put::u64(out, *offset);
                    }
                });
            });
        }
        self.chunks.push(ChunkIndex {
            from_ns,
            to_ns,
            offset,
            length: index_offset - offset,
            message_indexes,
            index_length: self.offset() - index_offset,
            compression: LZ4.to_owned(),
            compressed_size: compressed.len() as u64,
            size: raw_size,
        });
        for (channel, id) in self.channels.iter().zip(1..) {
            put_channel(&mut self.chunk.raw, id, channel.schema, &channel.topic);
        }
    }

    /// Adds an attachment after the messages so far.
    pub(crate) fn attach(&mut self, log_ns: u64, name: &str, media_type: &str, data: &[u8]) {
        self.end_chunk();
        let offset = self.offset();
        record(&mut self.out, op::ATTACHMENT, |out| {
            let start = out.len();
            put::u64(out, log_ns);
            put::u64(out, log_ns);
            put::text(out, name);
            put::text(out, media_type);
            put::u64(out, data.len() as u64);
            out.extend(data);
            let crc = CRC.checksum(out.get(start..).unwrap_or_default());
            put::u32(out, crc);
        });
        self.attachments.push(AttachmentIndex {
            offset,
            length: self.offset() - offset,
            log_ns,
            size: data.len() as u64,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
        });
    }

    /// Adds a metadata record.
    pub(crate) fn metadata(&mut self, name: &str, pairs: &[(&str, &str)]) {
        let offset = self.offset();
        record(&mut self.out, op::METADATA, |out| {
            put::text(out, name);
            put::texts(out, pairs);
        });
        self.metadata.push(MetadataIndex {
            offset,
            length: self.offset() - offset,
            name: name.to_owned(),
        });
    }

    /// Number of completed bytes that were not taken.
    pub(crate) const fn written(&self) -> usize {
        self.out.len()
    }

    /// Takes the completed bytes.
    pub(crate) fn take(&mut self) -> Vec<u8> {
        self.taken += self.out.len() as u64;
        self.crc.0.update(&self.out);
        std::mem::take(&mut self.out)
    }

    /// Writes the summary. Returns the bytes that were not taken.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        self.end_chunk();
        let mut last = self.take();
        let data_crc = self.crc.0.clone().finalize();
        record(&mut last, op::DATA_END, |out| put::u32(out, data_crc));
        let summary_start = self.taken + RECORD_DATA_END_LEN;
        let mut summary = Vec::new();
        let mut groups = Vec::new();
        let mut group = |summary: &mut Vec<u8>, opcode, write: &dyn Fn(&mut Vec<u8>)| {
            let start = summary.len();
            write(summary);
            if summary.len() > start {
                let length = (summary.len() - start) as u64;
                groups.push((opcode, summary_start + start as u64, length));
            }
        };
        group(&mut summary, op::SCHEMA, &|out| {
            for (schema, id) in self.schemas.iter().zip(1..) {
                put_schema(out, id, *schema);
            }
        });
        group(&mut summary, op::CHANNEL, &|out| {
            for (channel, id) in self.channels.iter().zip(1..) {
                put_channel(out, id, channel.schema, &channel.topic);
            }
        });
        group(&mut summary, op::STATISTICS, &|out| self.statistics(out));
        group(&mut summary, op::CHUNK_INDEX, &|out| {
            self.chunks.iter().for_each(|index| index.put(out));
        });
        group(&mut summary, op::ATTACHMENT_INDEX, &|out| {
            self.attachments.iter().for_each(|index| index.put(out));
        });
        group(&mut summary, op::METADATA_INDEX, &|out| {
            self.metadata.iter().for_each(|index| index.put(out));
        });
        let offsets_start = summary_start + summary.len() as u64;
        for (opcode, start, length) in groups {
            record(&mut summary, op::SUMMARY_OFFSET, |out| {
                out.push(opcode);
                put::u64(out, start);
                put::u64(out, length);
            });
        }
        // The CRC covers the summary and this record up to the CRC, with the record's final length.
        summary.push(op::FOOTER);
        put::u64(&mut summary, FOOTER_LEN);
        put::u64(&mut summary, summary_start);
        put::u64(&mut summary, offsets_start);
        let crc = CRC.checksum(&summary);
        put::u32(&mut summary, crc);
        last.extend(summary);
        last.extend(MAGIC);
        last
    }

    fn statistics(&self, out: &mut Vec<u8>) {
        let from_ns = self.chunks.iter().map(|chunk| chunk.from_ns).min();
        let to_ns = self.chunks.iter().map(|chunk| chunk.to_ns).max();
        let count = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
        record(out, op::STATISTICS, |out| {
            put::u64(out, self.channels.iter().map(|one| one.messages).sum());
            put::u16(out, u16::try_from(self.schemas.len()).unwrap_or(u16::MAX));
            put::u32(out, count(self.channels.len()));
            put::u32(out, count(self.attachments.len()));
            put::u32(out, count(self.metadata.len()));
            put::u32(out, count(self.chunks.len()));
            put::u64(out, from_ns.unwrap_or_default());
            put::u64(out, to_ns.unwrap_or_default());
            put::sized(out, |out| {
                for (channel, id) in self.channels.iter().zip(1..) {
                    put::u16(out, id);
                    put::u64(out, channel.messages);
                }
            });
        });
    }

    const fn offset(&self) -> u64 {
        self.taken + self.out.len() as u64
    }
}

/// Content of the footer: two offsets and a CRC.
const FOOTER_LEN: u64 = 20;

/// Length of the record between data and summary: head and CRC.
const RECORD_DATA_END_LEN: u64 = super::RECORD_HEAD_LEN + 4;

fn put_schema(out: &mut Vec<u8>, id: u16, (name, json): (&str, &str)) {
    record(out, op::SCHEMA, |out| {
        put::u16(out, id);
        put::text(out, name);
        put::text(out, "jsonschema");
        put::text(out, json);
    });
}

fn put_channel(out: &mut Vec<u8>, id: u16, schema: u16, topic: &str) {
    record(out, op::CHANNEL, |out| {
        put::u16(out, id);
        put::u16(out, schema);
        put::text(out, topic);
        put::text(out, "json");
        put::texts(out, &[]);
    });
}
