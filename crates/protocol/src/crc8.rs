//! The check byte of a frame.

use crc::{CRC_8_MAXIM_DOW, Crc, Table};

const MAXIM: Crc<u8, Table<1>> = Crc::<u8, Table<1>>::new(&CRC_8_MAXIM_DOW);

/// CRC-8/MAXIM of `bytes`: polynomial x^8 + x^5 + x^4 + 1, reflected, from 0.
///
/// A frame carries it in byte 9, computed over bytes 0-8.
///
/// ```
/// assert_eq!(motorlink_protocol::crc8(b"123456789"), 0xA1);
/// ```
#[must_use]
pub fn crc8(bytes: &[u8]) -> u8 {
    MAXIM.checksum(bytes)
}
