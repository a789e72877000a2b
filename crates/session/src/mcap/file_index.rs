//! The end of a file: the record that ends its data, and the summary.

use std::collections::BTreeMap;

use super::{
    CRC, MAGIC, RECORD_HEAD_LEN, op,
    open_chunk::MessageIndexes,
    put::{self, record},
    summary::{AttachmentIndex, ChunkIndex, MetadataIndex},
};

/// Content of the footer: two offsets and a CRC.
const FOOTER_LEN: u64 = 20;

/// Length of the record between data and summary: head and CRC.
const RECORD_DATA_END_LEN: u64 = RECORD_HEAD_LEN + 4;

/// What the summary of a file says.
#[derive(Debug, Default)]
pub(crate) struct FileIndex {
    /// The content of each schema's record, by its ID.
    schemas: BTreeMap<u16, Vec<u8>>,
    /// The content of each channel's record, by its ID.
    pub(crate) channels: BTreeMap<u16, Vec<u8>>,
    /// How many messages each channel has.
    pub(crate) messages: BTreeMap<u16, u64>,
    pub(crate) chunks: Vec<ChunkIndex>,
    pub(crate) attachments: Vec<AttachmentIndex>,
    pub(crate) metadata: Vec<MetadataIndex>,
}

impl FileIndex {
    /// The contents of the records with this opcode: schemas or channels.
    pub(crate) const fn declared(&mut self, opcode: u8) -> &mut BTreeMap<u16, Vec<u8>> {
        match opcode {
            op::SCHEMA => &mut self.schemas,
            _ => &mut self.channels,
        }
    }

    /// Counts the messages of a chunk.
    pub(crate) fn count(&mut self, indexes: &MessageIndexes) {
        for (channel, messages) in indexes {
            *self.messages.entry(*channel).or_default() += messages.len() as u64;
        }
    }

    /// Adds an attachment to `out`, which begins at this offset of the file.
    pub(crate) fn attach(
        &mut self,
        out: &mut Vec<u8>,
        out_at: u64,
        log_ns: u64,
        (name, media_type): (&str, &str),
        data: &[u8],
    ) {
        let offset = out_at + out.len() as u64;
        record(out, op::ATTACHMENT, |out| {
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
            length: out_at + out.len() as u64 - offset,
            log_ns,
            size: data.len() as u64,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
        });
    }

    /// The bytes behind the data, which has this length and CRC.
    pub(crate) fn end(&self, data_len: u64, data_crc: u32) -> Vec<u8> {
        let mut last = Vec::new();
        record(&mut last, op::DATA_END, |out| put::u32(out, data_crc));
        let summary_start = data_len + RECORD_DATA_END_LEN;
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
        let contents = |out: &mut Vec<u8>, opcode, contents: &BTreeMap<u16, Vec<u8>>| {
            for content in contents.values() {
                record(out, opcode, |out| out.extend(content));
            }
        };
        group(&mut summary, op::SCHEMA, &|out| {
            contents(out, op::SCHEMA, &self.schemas);
        });
        group(&mut summary, op::CHANNEL, &|out| {
            contents(out, op::CHANNEL, &self.channels);
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
            put::u64(out, self.messages.values().sum());
            put::u16(out, u16::try_from(self.schemas.len()).unwrap_or(u16::MAX));
            put::u32(out, count(self.channels.len()));
            put::u32(out, count(self.attachments.len()));
            put::u32(out, count(self.metadata.len()));
            put::u32(out, count(self.chunks.len()));
            put::u64(out, from_ns.unwrap_or_default());
            put::u64(out, to_ns.unwrap_or_default());
            put::sized(out, |out| {
                for (id, messages) in &self.messages {
                    put::u16(out, *id);
                    put::u64(out, *messages);
                }
            });
        });
    }
}
