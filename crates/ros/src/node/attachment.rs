//! What goes with each message of `rmw_zenoh`: its number, its time, and its publisher or client.

use std::time::{SystemTime, UNIX_EPOCH};

use zenoh::bytes::ZBytes;
use zenoh_ext::{ZDeserializer, ZSerializer};

/// Number, time and sender of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Counts the messages of the sender, from 1.
    pub number: i64,
    /// Nanoseconds since 1970, by the clock of the sender.
    pub sent_ns: i64,
    /// The publisher or client.
    pub sender: [u8; 16],
}

impl Attachment {
    /// That of a message which is sent now.
    #[must_use]
    pub fn now(number: i64, sender: [u8; 16]) -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let sent_ns = since.map_or(0, |since| i64::try_from(since.as_nanos()).unwrap_or(0));
        Self {
            number,
            sent_ns,
            sender,
        }
    }

    /// Its bytes: two numbers of 8 bytes, little-endian, and 16 bytes behind their length.
    #[must_use]
    pub fn write(self) -> ZBytes {
        let mut writer = ZSerializer::new();
        writer.serialize(self.number);
        writer.serialize(self.sent_ns);
        writer.serialize(self.sender);
        writer.finish()
    }

    /// Reads it; `None` if it is none.
    #[must_use]
    pub fn read(bytes: &ZBytes) -> Option<Self> {
        let mut reader = ZDeserializer::new(bytes);
        Some(Self {
            number: reader.deserialize().ok()?,
            sent_ns: reader.deserialize().ok()?,
            sender: reader.deserialize().ok()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_attachment_has_33_bytes_and_is_read_as_it_was_written() {
        let attachment = Attachment {
            number: 2,
            sent_ns: 0x0102_0304,
            sender: [7; 16],
        };
        let bytes = attachment.write();
        let expected = [
            &[2, 0, 0, 0, 0, 0, 0, 0, 4, 3, 2, 1, 0, 0, 0, 0, 16][..],
            &[7; 16],
        ]
        .concat();
        assert_eq!(bytes.to_bytes(), expected);
        assert_eq!(Attachment::read(&bytes), Some(attachment));
        assert_eq!(Attachment::read(&ZBytes::from(vec![1, 2, 3])), None);
    }
}
