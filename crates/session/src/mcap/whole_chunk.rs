//! Writes a chunk and the message indexes behind it.

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

/// A chunk that is complete.
#[derive(Debug)]
pub(crate) struct WholeChunk<'a> {
    /// Its records.
    pub(crate) raw: &'a [u8],
    /// The least and the greatest time of its messages.
    pub(crate) times: (u64, u64),
    pub(crate) indexes: &'a MessageIndexes,
}

impl WholeChunk<'_> {
    /// Adds it to `out`, which begins at this offset of the file. Returns its index.
    pub(crate) fn put(&self, out: &mut Vec<u8>, out_at: u64) -> ChunkIndex {
        let offset = out_at + out.len() as u64;
        let compressed = compression::compress(self.raw);
        let (from_ns, to_ns) = self.times;
        let size = self.raw.len() as u64;
        record(out, op::CHUNK, |out| {
            put::u64(out, from_ns);
            put::u64(out, to_ns);
            put::u64(out, size);
            put::u32(out, CRC.checksum(self.raw));
            put::text(out, LZ4);
            put::u64(out, compressed.len() as u64);
            out.extend(&compressed);
        });
        let index_offset = out_at + out.len() as u64;
        let mut message_indexes = Vec::new();
        for (channel, messages) in self.indexes {
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
        ChunkIndex {
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
        }
    }
}
