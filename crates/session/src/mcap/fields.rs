//! Parses records and their fields from untrusted bytes.

/// The fields of a record, in order. A field is `None` if the bytes are too short.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fields<'a>(pub(crate) &'a [u8]);

impl<'a> Fields<'a> {
    pub(crate) fn take(&mut self, length: u64) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(usize::try_from(length).ok()?)?;
        self.0 = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    pub(crate) fn u8(&mut self) -> Option<u8> {
        self.array().map(|[byte]| byte)
    }

    pub(crate) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// Bytes after their length in 32 bits.
    pub(crate) fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = self.u32()?;
        self.take(length.into())
    }

    pub(crate) fn text(&mut self) -> Option<&'a str> {
        std::str::from_utf8(self.bytes()?).ok()
    }

    /// Pairs of texts after their length in bytes.
    pub(crate) fn texts(&mut self) -> Option<Vec<(String, String)>> {
        let mut pairs = Fields(self.bytes()?);
        let mut read = Vec::new();
        while !pairs.0.is_empty() {
            read.push((pairs.text()?.to_owned(), pairs.text()?.to_owned()));
        }
        Some(read)
    }

    /// The next record: its opcode and its content.
    pub(crate) fn record(&mut self) -> Option<(u8, &'a [u8])> {
        let mut ahead = *self;
        let opcode = ahead.u8()?;
        let length = ahead.u64()?;
        let content = ahead.take(length)?;
        *self = ahead;
        Some((opcode, content))
    }

    /// The ID and the topic at the head of a channel's record.
    pub(crate) fn channel_head(&mut self) -> Option<(u16, &'a str)> {
        let (id, _schema) = (self.u16()?, self.u16()?);
        Some((id, self.text()?))
    }

    /// Channel and time at the head of a message. Its data follows.
    pub(crate) fn message_head(&mut self) -> Option<(u16, u64)> {
        let (channel, _sequence) = (self.u16()?, self.u32()?);
        let (log_ns, _published_ns) = (self.u64()?, self.u64()?);
        Some((channel, log_ns))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mcap::put;

    #[test]
    fn what_was_put_is_read() {
        let mut bytes = Vec::new();
        put::record(&mut bytes, 7, |out| {
            put::u16(out, 0xABCD);
            put::text(out, "speed");
            put::texts(out, &[("a", "b")]);
        });
        let mut records = Fields(&bytes);
        let (opcode, content) = records.record().unwrap();
        let mut fields = Fields(content);
        assert_eq!((opcode, fields.u16()), (7, Some(0xABCD)));
        assert_eq!(fields.text(), Some("speed"));
        assert_eq!(fields.texts().unwrap(), [("a".into(), "b".into())]);
        assert!(fields.0.is_empty() && records.record().is_none());
    }

    #[test]
    fn a_record_that_is_cut_is_none() {
        let mut bytes = Vec::new();
        put::record(&mut bytes, 7, |out| put::u64(out, 1));
        for length in 0..bytes.len() {
            assert!(Fields(&bytes[..length]).record().is_none());
        }
        let endless = [1, 255, 255, 255, 255, 255, 255, 255, 255, 0];
        assert!(Fields(&endless).record().is_none());
    }
}
