//! Reads and writes the records of the MCAP container. This module does not depend on motors.
//!
//! Source: <https://mcap.dev/spec>. A record is an opcode, a length and content of this length:
//!
//! | bytes | content |
//! |---|---|
//! | 0 | opcode |
//! | 1-8 | length of the content, little endian |
//! | 9.. | content |
//!
//! The `mcap` crate does the same, but adds 93 kB gzipped to the page, even without compression. This module has only
//! what a session needs. The tests read its files with that crate.

pub(crate) mod compression;
pub(crate) mod container;
pub(crate) mod fields;
pub(crate) mod file_index;
pub(crate) mod open_chunk;
pub(crate) mod put;
pub(crate) mod summary;

use crc::{CRC_32_ISO_HDLC, Crc};

/// The first and the last bytes of a file. The sixth is the major version, `0`.
pub(crate) const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// Opcode and length of a record.
pub(crate) const RECORD_HEAD_LEN: u64 = 9;

/// Length of the footer record and the magic after it.
pub(crate) const TAIL_LEN: u64 = RECORD_HEAD_LEN + 20 + 8;

/// Maximal bytes of a chunk before compression. Writers use a few megabytes; a larger value is a sign of damage.
pub(crate) const CHUNK_BYTES_MAX: u64 = 16 << 20;

/// The CRC of every part of the file.
pub(crate) static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Opcodes.
pub(crate) mod op {
    pub(crate) const HEADER: u8 = 0x01;
    pub(crate) const FOOTER: u8 = 0x02;
    pub(crate) const SCHEMA: u8 = 0x03;
    pub(crate) const CHANNEL: u8 = 0x04;
    pub(crate) const MESSAGE: u8 = 0x05;
    pub(crate) const CHUNK: u8 = 0x06;
    pub(crate) const MESSAGE_INDEX: u8 = 0x07;
    pub(crate) const CHUNK_INDEX: u8 = 0x08;
    pub(crate) const ATTACHMENT: u8 = 0x09;
    pub(crate) const ATTACHMENT_INDEX: u8 = 0x0A;
    pub(crate) const STATISTICS: u8 = 0x0B;
    pub(crate) const METADATA: u8 = 0x0C;
    pub(crate) const METADATA_INDEX: u8 = 0x0D;
    pub(crate) const SUMMARY_OFFSET: u8 = 0x0E;
    pub(crate) const DATA_END: u8 = 0x0F;
}
