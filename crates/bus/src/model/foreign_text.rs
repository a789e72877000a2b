//! Text on the line: another device than a motor sends on this port.

use std::time::Duration;

use motorlink_protocol::Instant;

/// So many bytes of text in a row are no noise: of random bytes, 64 are text once in 10^26 times.
const TEXT_MIN: usize = 64;

/// Two texts in JSON within this time are no noise.
const JSON_WITHIN: Duration = Duration::from_secs(1);

/// A device that has sent no text for this long may be gone, or has booted: then motors are asked again.
pub(crate) const TEXT_GONE: Duration = Duration::from_secs(5);

/// Bytes that are all text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Text {
    bytes: usize,
    /// Whether an object in JSON begins in it.
    is_json: bool,
}

impl Text {
    /// These bytes as text, if they are.
    pub(crate) fn of(bytes: &[u8]) -> Option<Self> {
        let is_text = !bytes.is_empty() && bytes.iter().copied().all(is_text);
        is_text.then(|| Self {
            bytes: bytes.len(),
            is_json: bytes.windows(2).any(|pair| pair == b"{\""),
        })
    }

    /// Whether it is too long for noise: of random bytes, eight are text once in 2,000 times.
    pub(crate) const fn is_long(self) -> bool {
        self.bytes >= 8
    }
}

/// Whether a log has this byte: a printable character, the end of a line, a tabulator, or the start of a colour.
pub(crate) const fn is_text(byte: u8) -> bool {
    matches!(byte, b' '..=b'~' | b'\r' | b'\n' | b'\t' | 0x1B)
}

/// The text that was heard.
#[derive(Clone, Debug, Default)]
pub(crate) struct ForeignText {
    in_a_row: usize,
    last: Option<Instant>,
    json: Option<Instant>,
    is_reported: bool,
}

impl ForeignText {
    /// Records bytes that are no frame; `None` if they are no text. Returns what to report, once: whether the text is in
    /// JSON.
    pub(crate) fn heard(&mut self, now: Instant, text: Option<Text>) -> Option<bool> {
        let Some(text) = text else {
            self.in_a_row = 0;
            return None;
        };
        let is_old = |at: Instant| now.since(at) > JSON_WITHIN;
        let is_json = text.is_json && self.json.is_some_and(|at| !is_old(at));
        if text.is_json {
            self.json = Some(now);
        }
        self.in_a_row = self.in_a_row.saturating_add(text.bytes);
        let is_plain = self.in_a_row >= TEXT_MIN && self.json.is_none_or(is_old);
        if self.is_reported || is_json || is_plain {
            self.last = Some(now);
        }
        let is_new = !self.is_reported && (is_json || is_plain);
        self.is_reported |= is_new;
        is_new.then_some(is_json)
    }

    /// Whether a device that was reported still sends.
    pub(crate) fn is_heard(&self, now: Instant) -> bool {
        self.last.is_some_and(|at| now.since(at) < TEXT_GONE)
    }

    /// Reports text again.
    pub(crate) fn report_again(&mut self) {
        self.is_reported = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: u64) -> Instant {
        Instant::from_millis(ms)
    }

    #[test]
    fn text_is_distinguished_from_noise() {
        let json = Text::of(b"{\"T\":20010,\"id\":1}\r\n").unwrap();
        assert!(json.is_json);
        assert!(
            !Text::of(b"\x1B[0;32mI (27) boot: ESP-IDF\r\n")
                .unwrap()
                .is_json
        );
        assert_eq!(Text::of(&[0x7B, 0x22, 0x80]), None);
        assert_eq!(Text::of(&[]), None);
    }

    #[test]
    fn text_is_reported_once_and_is_gone_after_a_pause() {
        let mut heard = ForeignText::default();
        let text = Text::of(b"rst:0x1 (POWERON_RESET),boot:0x13");
        assert_eq!(heard.heard(at(0), text), None);
        assert!(!heard.is_heard(at(0)));
        assert_eq!(heard.heard(at(1), None), None, "noise");
        assert_eq!(heard.heard(at(2), text), None);
        assert_eq!(heard.heard(at(3), text), Some(false));
        assert_eq!(heard.heard(at(4), text), None);
        assert!(heard.is_heard(at(5_003)) && !heard.is_heard(at(5_004)));
    }

    #[test]
    fn two_objects_within_a_second_are_json() {
        let mut heard = ForeignText::default();
        let text = Text::of(b"{\"T\":1005}\r\n");
        assert_eq!(heard.heard(at(0), text), None);
        assert_eq!(heard.heard(at(1_001), text), None);
        assert_eq!(heard.heard(at(2_001), text), Some(true));
    }
}
