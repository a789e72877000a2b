//! The writer of the container: takes messages, and returns bytes when they are complete.

use crc::Digest;

use super::{
    CRC, MAGIC,
    file_index::FileIndex,
    op,
    put::{self, record},
    summary::{AttachmentIndex, MetadataIndex},
    whole_chunk::{MessageIndexes, WholeChunk},
};

/// Bytes per chunk before compression: two and a half seconds of 500 exchanges a second. A seek decompresses one chunk, in 1 ms.
/// Chunks of twice the size make the file 2 % smaller.
const CHUNK_BYTES: usize = 512 << 10;

/// Maximal time per chunk, so that a truncated file loses no more.
const CHUNK_NS: u64 = 10_000_000_000;

/// The encoding of messages with a schema.
pub(crate) const JSON: &str = "json";

/// A registered channel.
#[derive(Debug)]
struct Channel {
    schema: u16,
    topic: String,
    encoding: &'static str,
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
    index: FileIndex,
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
    indexes: MessageIndexes,
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
            index: FileIndex::default(),
        }
    }

    /// Registers a JSON schema. Returns its ID.
    pub(crate) fn schema(&mut self, name: &'static str, json: &'static str) -> u16 {
        self.schemas.push((name, json));
        let id = u16::try_from(self.schemas.len()).unwrap_or(u16::MAX);
        put_schema(&mut self.chunk.raw, id, (name, json));
        id
    }

    /// Registers a channel with JSON messages. Returns its ID.
    pub(crate) fn channel(&mut self, schema: u16, topic: String) -> u16 {
        self.add_channel(schema, topic, JSON)
    }

    /// Registers a channel whose messages have an encoding of our own and no schema. Returns its ID.
    pub(crate) fn own_channel(&mut self, encoding: &'static str, topic: &str) -> u16 {
        self.add_channel(0, topic.to_owned(), encoding)
    }

    fn add_channel(&mut self, schema: u16, topic: String, encoding: &'static str) -> u16 {
        let id = u16::try_from(self.channels.len() + 1).unwrap_or(u16::MAX);
        let channel = Channel {
            schema,
            topic,
            encoding,
            messages: 0,
        };
        put_channel(&mut self.chunk.raw, id, &channel);
        self.channels.push(channel);
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
        let Some(known) = self.channels.get_mut(usize::from(channel.wrapping_sub(1))) else {
            return;
        };
        known.messages += 1;
        let chunk = &mut self.chunk;
        let offset = chunk.raw.len() as u64;
        record(&mut chunk.raw, op::MESSAGE, |out| {
            put::u16(out, channel);
            // No sequence number: one that grows makes the file of an hour 8 MB larger.
            put::u32(out, 0);
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
        let chunk = WholeChunk {
            raw: &chunk.raw,
            times: (from_ns, to_ns),
            indexes: &chunk.indexes,
        };
        let index = chunk.put(&mut self.out, self.taken);
        self.index.chunks.push(index);
        for (channel, id) in self.channels.iter().zip(1..) {
            put_channel(&mut self.chunk.raw, id, channel);
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
        self.index.attachments.push(AttachmentIndex {
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
        for (schema, id) in self.schemas.iter().zip(1..) {
            self.index.schemas.insert(id, schema_content(id, *schema));
        }
        for (channel, id) in self.channels.iter().zip(1..) {
            let content = channel_content(id, channel.schema, &channel.topic, channel.encoding);
            self.index.channels.insert(id, content);
            self.index.messages.insert(id, channel.messages);
        }
        let data_crc = self.crc.0.clone().finalize();
        last.extend(self.index.end(self.taken, data_crc));
        last
    }

    const fn offset(&self) -> u64 {
        self.taken + self.out.len() as u64
    }
}

fn put_schema(out: &mut Vec<u8>, id: u16, schema: (&str, &str)) {
    record(out, op::SCHEMA, |out| {
        out.extend(schema_content(id, schema));
    });
}

fn put_channel(out: &mut Vec<u8>, id: u16, channel: &Channel) {
    let content = channel_content(id, channel.schema, &channel.topic, channel.encoding);
    record(out, op::CHANNEL, |out| out.extend(content));
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
