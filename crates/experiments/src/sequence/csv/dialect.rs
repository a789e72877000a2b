//! How a CSV file is written: its encoding, its separator and its decimal mark.

use crate::sequence::{Problem, SequenceError};

/// The text of a file: see [`Decoder`].
///
/// # Errors
/// Bytes that are no such text.
pub fn text_of(bytes: &[u8]) -> Result<String, SequenceError> {
    let text = String::from_utf8(Decoder::default().decode(bytes, true)).ok();
    let text = text.filter(|text| !text.contains('\0'));
    text.ok_or_else(|| SequenceError::at("", Problem::NotText))
}

/// Makes UTF-8 of a file piece by piece: of UTF-8, or of UTF-16 with its mark, as Excel writes "Unicode text".
#[derive(Clone, Debug, Default)]
pub struct Decoder {
    form: Option<Form>,
    /// Bytes of the piece before that are no whole letter.
    rest: Vec<u8>,
}

#[derive(Clone, Copy, Debug)]
enum Form {
    Utf8,
    /// A unit of two bytes.
    Utf16(fn([u8; 2]) -> u16),
}

/// A byte that no UTF-8 has, instead of what is no letter.
const NO_TEXT: u8 = 0xFF;

impl Decoder {
    /// The text of the next bytes. What is invalid stays invalid UTF-8.
    pub fn decode(&mut self, bytes: &[u8], is_last: bool) -> Vec<u8> {
        self.rest.extend(bytes);
        let form = match (self.form, &*self.rest) {
            (Some(form), _) => form,
            (None, [] | [_]) if !is_last => return Vec::new(),
            (None, [0xFF, 0xFE, ..]) => self.begin_utf_16(u16::from_le_bytes),
            (None, [0xFE, 0xFF, ..]) => self.begin_utf_16(u16::from_be_bytes),
            (None, _) => Form::Utf8,
        };
        self.form = Some(form);
        let Form::Utf16(unit) = form else {
            return std::mem::take(&mut self.rest);
        };
        let pairs = self.rest.chunks_exact(2);
        let mut units: Vec<u16> = pairs
            .filter_map(|pair| pair.try_into().ok())
            .map(unit)
            .collect();
        // The second half of a letter may be in the next piece.
        let is_half = |unit: &mut u16| (0xD800..0xDC00).contains(unit);
        if !is_last {
            units.pop_if(is_half);
        }
        self.rest.drain(..2 * units.len());
        let mut text = Vec::new();
        for letter in char::decode_utf16(units) {
            match letter {
                Ok(letter) => text.extend(letter.encode_utf8(&mut [0; 4]).bytes()),
                Err(_) => text.push(NO_TEXT),
            }
        }
        if is_last && !self.rest.is_empty() {
            text.push(NO_TEXT);
        }
        text
    }

    fn begin_utf_16(&mut self, unit: fn([u8; 2]) -> u16) -> Form {
        self.rest.drain(..2);
        Form::Utf16(unit)
    }
}

/// What separates the columns of a text, which need not be whole; the text without its mark and behind the line `sep=;` of
/// Excel; and the number of lines before it.
#[must_use]
pub fn separator_of(text: &[u8]) -> (u8, &[u8], usize) {
    let text = text.strip_prefix("\u{FEFF}".as_bytes()).unwrap_or(text);
    let mut lines = text.splitn(2, |byte| *byte == b'\n');
    let first = lines.next().unwrap_or_default();
    if let Some([separator, ..]) = first.strip_prefix(b"sep=") {
        return (*separator, lines.next().unwrap_or_default(), 1);
    }
    let separator = if first.contains(&b'\t') {
        b'\t'
    } else if first.contains(&b';') {
        b';'
    } else {
        b','
    };
    (separator, text, 0)
}

/// Separator and decimal mark.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dialect {
    pub(super) delimiter: u8,
    /// Whether a field has a comma: then a point is no decimal mark.
    has_commas: bool,
}

impl Dialect {
    /// The dialect of a text, and what [`separator_of`] says of it.
    pub(super) fn of(text: &str) -> (Self, &str, usize) {
        let (delimiter, rest, before) = separator_of(text.as_bytes());
        let rest = text.get(text.len() - rest.len()..).unwrap_or_default();
        let has_commas = delimiter != b',' && rest.contains(',');
        let dialect = Self {
            delimiter,
            has_commas,
        };
        (dialect, rest, before)
    }

    /// Reads a number. `1.000` is a thousand where a comma is the decimal mark, so it is refused unless only one meaning is
    /// possible.
    pub(super) fn number(self, text: &str) -> Result<f64, Problem> {
        let text = text.trim();
        let marks = text.bytes().filter(|byte| matches!(byte, b'.' | b','));
        let read = if self.delimiter == b',' {
            if text.contains(',') {
                return Err(Problem::ThousandsMark);
            }
            text.parse::<f64>()
        } else {
            let is_other = self.has_commas && text.contains('.');
            let may_be_thousands = self.delimiter == b'\t' || text.contains('.');
            if is_other || marks.count() > 1 || may_be_thousands && looks_like_thousands(text) {
                return Err(Problem::ThousandsMark);
            }
            text.replace(',', ".").parse::<f64>()
        };
        let finite = read.ok().filter(|number| number.is_finite());
        finite.ok_or(Problem::Expected("a number"))
    }
}

/// `1.000`, `-250,000`: one to three digits, the first of them no zero, and a group of three.
fn looks_like_thousands(text: &str) -> bool {
    let digits = text.trim_start_matches(['+', '-']);
    let Some((before, after)) = digits.split_once(['.', ',']) else {
        return false;
    };
    let are_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    (1..=3).contains(&before.len())
        && after.len() == 3
        && !before.starts_with('0')
        && are_digits(before)
        && are_digits(after)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utf_16_is_decoded_in_pieces_of_any_size() {
        let text = "a;°\u{1F600}\r\n试";
        for unit in [u16::to_le_bytes, u16::to_be_bytes] {
            let units = std::iter::once(0xFEFF).chain(text.encode_utf16());
            let bytes: Vec<u8> = units.flat_map(unit).collect();
            for size in 1..=bytes.len() {
                let mut decoder = Decoder::default();
                let pieces = bytes.chunks(size);
                let mut read: Vec<u8> = pieces
                    .flat_map(|piece| decoder.decode(piece, false))
                    .collect();
                read.extend(decoder.decode(&[], true));
                assert_eq!(String::from_utf8(read).unwrap(), text, "{size}");
            }
            assert!(text_of(&bytes[..bytes.len() - 1]).is_err());
            assert!(text_of(&bytes[..10]).is_err(), "half of a letter");
        }
        assert_eq!(text_of("°".as_bytes()).unwrap(), "°");
        assert!(text_of(b"\xC2").is_err() && text_of(b"a\0").is_err());
    }

    #[test]
    fn the_separator_is_that_of_the_first_line() {
        for (text, separator, rest, before) in [
            ("a,b\n1;2", b',', "a,b\n1;2", 0),
            ("\u{FEFF}a;b\n1,5;2", b';', "a;b\n1,5;2", 0),
            ("a\tb;c", b'\t', "a\tb;c", 0),
            ("\u{FEFF}sep=|\r\na|b", b'|', "a|b", 1),
            ("sep=", b',', "sep=", 0),
            ("", b',', "", 0),
        ] {
            let expected = (separator, rest.as_bytes(), before);
            assert_eq!(separator_of(text.as_bytes()), expected, "{text}");
        }
    }
}
