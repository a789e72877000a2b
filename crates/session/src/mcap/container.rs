//! The writer of the container: takes messages, and returns bytes when they are complete.

use crc::Digest;

use super::{
    CRC, MAGIC,
    file_index::FileIndex,
    op,
    open_chunk::OpenChunk,
    put::{self, record},
    summary::MetadataIndex,
};

/// Bytes per chunk before compression: two and a half seconds of 500 exchanges a second. A seek decompresses one chunk, in 1 ms.
/// Chunks of twice the size make the file 2 % smaller.
const CHUNK_BYTES: usize = 512 << 10;

/// Maximal time per chunk, so that a truncated file loses no more.
const CHUNK_NS: u64 = 10_000_000_000;

/// The encoding of messages with a schema.
pub(crate) const JSON: &str = "json";

/// Writes the container.
#[derive(Debug)]
pub(crate) struct Container {
    out: Vec<u8>,
    /// Number of bytes that were taken before those in `out`.
    taken: u64,
    /// The CRC of everything before `out`.
    crc: DataCrc,
    chunk: OpenChunk,
    index: FileIndex,
}

/// A CRC of bytes that were taken already.
struct DataCrc(Digest<'static, u32>);

impl std::fmt::Debug for DataCrc {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("DataCrc")
    }
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
            chunk: OpenChunk::default(),
            index: FileIndex::default(),
        }
    }

    /// Registers a JSON schema. Returns its ID.
    pub(crate) fn schema(&mut self, name: &str, json: &str) -> u16 {
        self.declare(op::SCHEMA, &|id| schema_content(id, (name, json)))
    }

    /// Registers a channel with JSON messages. Returns its ID.
    pub(crate) fn channel(&mut self, schema: u16, topic: &str) -> u16 {
        self.add_channel(schema, topic, JSON)
    }

    /// Registers a channel whose messages have an encoding of our own and no schema. Returns its ID.
    pub(crate) fn own_channel(&mut self, encoding: &str, topic: &str) -> u16 {
        self.add_channel(0, topic, encoding)
    }

    fn add_channel(&mut self, schema: u16, topic: &str, encoding: &str) -> u16 {
        let id = self.declare(op::CHANNEL, &|id| {
            channel_content(id, schema, topic, encoding)
        });
        self.index.messages.insert(id, 0);
        id
    }

    /// Adds the record of a schema or a channel. Returns its ID.
    fn declare(&mut self, opcode: u8, content: &dyn Fn(u16) -> Vec<u8>) -> u16 {
        let known = self.index.declared(opcode);
        let id = u16::try_from(known.len() + 1).unwrap_or(u16::MAX);
        let content = content(id);
        record(&mut self.chunk.raw, opcode, |out| out.extend(&content));
        known.insert(id, content);
        id
    }

    /// Whether a message at this time begins another chunk.
    fn is_full(&self, log_ns: u64) -> bool {
        let from = self.chunk.times.map_or(log_ns, |(from, _)| from);
        self.chunk.raw.len() >= CHUNK_BYTES || log_ns.abs_diff(from) >= CHUNK_NS
    }

    /// Whether a message at this time is the first of its channel in its chunk.
    pub(crate) fn is_first(&self, channel: u16, log_ns: u64) -> bool {
        self.is_full(log_ns) || !self.chunk.indexes.contains_key(&channel)
    }

    /// Adds a message to the chunk being filled.
    pub(crate) fn message(&mut self, channel: u16, log_ns: u64, data: &[u8]) {
        if self.is_full(log_ns) {
            self.end_chunk();
        }
        if let Some(messages) = self.index.messages.get_mut(&channel) {
            *messages += 1;
            self.chunk.message(channel, log_ns, data);
        }
    }

    /// Writes the chunk being filled. Each chunk contains its channels again, so that it can be read if others are
    /// damaged.
    pub(crate) fn end_chunk(&mut self) {
        let Some(index) = self.chunk.put(&mut self.out, self.taken) else {
            return;
        };
        self.index.chunks.push(index);
        self.chunk = OpenChunk::default();
        for content in self.index.channels.values() {
            record(&mut self.chunk.raw, op::CHANNEL, |out| out.extend(content));
        }
    }

    /// Adds an attachment after the messages so far.
    pub(crate) fn attach(&mut self, log_ns: u64, name: &str, media_type: &str, data: &[u8]) {
        self.end_chunk();
        self.index
            .attach(&mut self.out, self.taken, log_ns, (name, media_type), data);
    }

    /// Adds a metadata record.
    pub(crate) fn metadata(&mut self, name: &str, pairs: &[(&str, &str)]) {
        let offset = self.offset();
        record(&mut self.out, op::METADATA, |out| {
            put::text(out, name);
            put::texts(out, pairs);
        });
        self.index.metadata.push(MetadataIndex {
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
        last.extend(self.index.end(self.taken, data_crc));
        last
    }

    const fn offset(&self) -> u64 {
        self.taken + self.out.len() as u64
    }
}

/// The content of the record of a JSON schema.
pub(crate) fn schema_content(id: u16, (name, json): (&str, &str)) -> Vec<u8> {
    let mut out = Vec::new();
    put::u16(&mut out, id);
    put::text(&mut out, name);
    put::text(&mut out, "jsonschema");
    put::text(&mut out, json);
    out
}

/// The content of the record of a channel.
pub(crate) fn channel_content(id: u16, schema: u16, topic: &str, encoding: &str) -> Vec<u8> {
    let mut out = Vec::new();
    put::u16(&mut out, id);
    put::u16(&mut out, schema);
    put::text(&mut out, topic);
    put::text(&mut out, encoding);
    put::texts(&mut out, &[]);
    out
}
