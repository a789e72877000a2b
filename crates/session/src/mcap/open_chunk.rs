//! Fills a chunk, and writes it and the message indexes behind it.

use std::collections::BTreeMap;

use super::{
    CRC,
    compression::{self, LZ4},
    op,
    put::{self, record},
    summary::ChunkIndex,
};

/// By channel: time and offset in the chunk of each message.
pub(crate) type MessageIndexes = BTreeMap<u16, Vec<(u64, u64)>>;

/// A chunk being filled.
#[derive(Debug, Default)]
pub(crate) struct OpenChunk {
    /// Its records.
    pub(crate) raw: Vec<u8>,
    /// The least and the greatest time of its messages.
    pub(crate) times: Option<(u64, u64)>,
    pub(crate) indexes: MessageIndexes,
}

impl OpenChunk {
    /// Adds a message.
    pub(crate) fn message(&mut self, channel: u16, log_ns: u64, data: &[u8]) {
        self.index(channel, log_ns);
        record(&mut self.raw, op::MESSAGE, |out| {
            put::u16(out, channel);
            // No sequence number: one that grows makes the file of an hour 8 MB larger.
            put::u32(out, 0);
            put::u64(out, log_ns);
            put::u64(out, log_ns);
            out.extend(data);
        });
    }

    /// A message of this channel follows.
    pub(crate) fn index(&mut self, channel: u16, log_ns: u64) {
        let (from, to) = self.times.unwrap_or((log_ns, log_ns));
        self.times = Some((from.min(log_ns), to.max(log_ns)));
        let index = self.indexes.entry(channel).or_default();
        index.push((log_ns, self.raw.len() as u64));
    }

    /// Adds it to `out`, which begins at this offset of the file. Returns its index; `None` without a message.
    pub(crate) fn put(&self, out: &mut Vec<u8>, out_at: u64) -> Option<ChunkIndex> {
        let (from_ns, to_ns) = self.times?;
        let offset = out_at + out.len() as u64;
        let compressed = compression::compress(&self.raw);
        let size = self.raw.len() as u64;
        record(out, op::CHUNK, |out| {
            put::u64(out, from_ns);
            put::u64(out, to_ns);
            put::u64(out, size);
            put::u32(out, CRC.checksum(&self.raw));
            put::text(out, LZ4);
            put::u64(out, compressed.len() as u64);
            out.extend(&compressed);
        });
        let index_offset = out_at + out.len() as u64;
        let mut message_indexes = Vec::new();
        for (channel, messages) in &self.indexes {
            message_indexes.push((*channel, out_at + out.len() as u64));
            record(out, op::MESSAGE_INDEX, |out| {
                put::u16(out, *channel);
                put::sized(out, |out| {
                    for (time, offset) in messages {
                        put::u64(out, *time);
                        put::u64(out, *offset);
                    }
                });
            });
        }
        Some(ChunkIndex {
            from_ns,
            to_ns,
            offset,
            length: index_offset - offset,
            message_indexes,
            index_length: out_at + out.len() as u64 - index_offset,
            compression: LZ4.to_owned(),
            compressed_size: compressed.len() as u64,
            size,
            is_loose: false,
        })
    }
}
