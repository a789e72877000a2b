//! The records of the summary: the index of the file.

use super::{
    fields::Fields,
    op,
    put::{self, record},
};

/// The position and the content of a chunk.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct ChunkIndex {
    pub(crate) from_ns: u64,
    pub(crate) to_ns: u64,
    /// Offset of the chunk's record, including its opcode.
    pub(crate) offset: u64,
    pub(crate) length: u64,
    /// The offset of the message index of each channel.
    pub(crate) message_indexes: Vec<(u16, u64)>,
    pub(crate) index_length: u64,
    pub(crate) compression: String,
    pub(crate) compressed_size: u64,
    pub(crate) size: u64,
    /// It is no chunk: messages that follow each other outside of chunks, which are read as one.
    pub(crate) is_loose: bool,
}

impl ChunkIndex {
    pub(crate) fn put(&self, out: &mut Vec<u8>) {
        record(out, op::CHUNK_INDEX, |out| {
            put::u64(out, self.from_ns);
            put::u64(out, self.to_ns);
            put::u64(out, self.offset);
            put::u64(out, self.length);
            put::sized(out, |out| {
                for (channel, offset) in &self.message_indexes {
                    put::u16(out, *channel);
                    put::u64(out, *offset);
                }
            });
            put::u64(out, self.index_length);
            put::text(out, &self.compression);
            put::u64(out, self.compressed_size);
            put::u64(out, self.size);
        });
    }

    /// Parses the record without the message indexes: the reader of sessions reads whole chunks.
    pub(crate) fn read(content: &[u8]) -> Option<Self> {
        let mut fields = Fields(content);
        let (from_ns, to_ns) = (fields.u64()?, fields.u64()?);
        let (offset, length) = (fields.u64()?, fields.u64()?);
        fields.bytes()?;
        Some(Self {
            from_ns,
            to_ns,
            offset,
            length,
            index_length: fields.u64()?,
            compression: fields.text()?.to_owned(),
            compressed_size: fields.u64()?,
            size: fields.u64()?,
            ..Self::default()
        })
    }

    /// The same from the head of a chunk at this offset, for a file without a summary.
    pub(crate) fn of_chunk(offset: u64, content_length: u64, head: &[u8]) -> Option<Self> {
        let head = ChunkHead::read(&mut Fields(head))?;
        Some(Self {
            from_ns: head.from_ns,
            to_ns: head.to_ns,
            offset,
            length: content_length.checked_add(super::RECORD_HEAD_LEN)?,
            compression: head.compression.to_owned(),
            compressed_size: head.compressed_size,
            size: head.size,
            ..Self::default()
        })
    }

    /// The messages outside of chunks that begin with one at this offset, without it.
    pub(crate) fn of_loose(offset: u64, log_ns: u64) -> Self {
        Self {
            from_ns: log_ns,
            to_ns: log_ns,
            offset,
            is_loose: true,
            ..Self::default()
        }
    }

    /// Takes another message behind them.
    pub(crate) const fn add_loose(&mut self, length: u64, log_ns: u64) {
        self.length = self.length.saturating_add(length);
        self.size = self.length;
        if log_ns < self.from_ns {
            self.from_ns = log_ns;
        }
        if log_ns > self.to_ns {
            self.to_ns = log_ns;
        }
    }
}

/// The part of a chunk before the compressed bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChunkHead<'a> {
    pub(crate) from_ns: u64,
    pub(crate) to_ns: u64,
    pub(crate) size: u64,
    /// Zero if the writer computed none.
    pub(crate) crc: u32,
    pub(crate) compression: &'a str,
    pub(crate) compressed_size: u64,
}

impl<'a> ChunkHead<'a> {
    /// Maximal length of a head: the names of compressions are short.
    pub(crate) const LEN_MAX: u64 = 64;

    pub(crate) fn read(fields: &mut Fields<'a>) -> Option<Self> {
        Some(Self {
            from_ns: fields.u64()?,
            to_ns: fields.u64()?,
            size: fields.u64()?,
            crc: fields.u32()?,
            compression: fields.text()?,
            compressed_size: fields.u64()?,
        })
    }
}

/// The position of an attachment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct AttachmentIndex {
    pub(crate) offset: u64,
    pub(crate) length: u64,
    pub(crate) log_ns: u64,
    pub(crate) size: u64,
    pub(crate) name: String,
    pub(crate) media_type: String,
}

impl AttachmentIndex {
    pub(crate) fn put(&self, out: &mut Vec<u8>) {
        record(out, op::ATTACHMENT_INDEX, |out| {
            put::u64(out, self.offset);
            put::u64(out, self.length);
            put::u64(out, self.log_ns);
            put::u64(out, self.log_ns);
            put::u64(out, self.size);
            put::text(out, &self.name);
            put::text(out, &self.media_type);
        });
    }

    pub(crate) fn read(content: &[u8]) -> Option<Self> {
        let mut fields = Fields(content);
        let (offset, length) = (fields.u64()?, fields.u64()?);
        let (log_ns, _created_ns) = (fields.u64()?, fields.u64()?);
        Some(Self {
            offset,
            length,
            log_ns,
            size: fields.u64()?,
            name: fields.text()?.to_owned(),
            media_type: fields.text()?.to_owned(),
        })
    }

    /// The same from the head of an attachment at this offset, for a file without a summary.
    pub(crate) fn of_attachment(offset: u64, content_length: u64, head: &[u8]) -> Option<Self> {
        let mut fields = Fields(head);
        let (log_ns, _created_ns) = (fields.u64()?, fields.u64()?);
        let name = fields.text()?.to_owned();
        let media_type = fields.text()?.to_owned();
        Some(Self {
            offset,
            length: content_length.checked_add(super::RECORD_HEAD_LEN)?,
            log_ns,
            size: fields.u64()?,
            name,
            media_type,
        })
    }

    /// The data in an attachment's record; `None` if its CRC is wrong.
    pub(crate) fn data(record: &[u8]) -> Option<&[u8]> {
        let (opcode, content) = Fields(record).record()?;
        let (checked, crc) = content.split_last_chunk::<4>()?;
        let crc = u32::from_le_bytes(*crc);
        let holds = crc == 0 || crc == super::CRC.checksum(checked);
        let mut fields = Fields(checked);
        let (_log_ns, _created_ns) = (fields.u64()?, fields.u64()?);
        fields.text()?;
        fields.text()?;
        let length = fields.u64()?;
        fields
            .take(length)
            .filter(|_| holds && opcode == op::ATTACHMENT)
    }
}

/// The position of a metadata record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct MetadataIndex {
    pub(crate) offset: u64,
    pub(crate) length: u64,
    pub(crate) name: String,
}

impl MetadataIndex {
    pub(crate) fn put(&self, out: &mut Vec<u8>) {
        record(out, op::METADATA_INDEX, |out| {
            put::u64(out, self.offset);
            put::u64(out, self.length);
            put::text(out, &self.name);
        });
    }

    pub(crate) fn read(content: &[u8]) -> Option<Self> {
        let mut fields = Fields(content);
        Some(Self {
            offset: fields.u64()?,
            length: fields.u64()?,
            name: fields.text()?.to_owned(),
        })
    }
}
