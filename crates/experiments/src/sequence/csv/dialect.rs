//! How a CSV file is written: its encoding, its separator and its decimal mark.

use crate::sequence::{Problem, SequenceError};

/// The text of a file: UTF-8, or UTF-16 with its mark, as Excel writes "Unicode text".
///
/// # Errors
/// Bytes that are neither.
pub fn text_of(bytes: &[u8]) -> Result<String, SequenceError> {
    let utf_16 = |rest: &[u8], unit: fn([u8; 2]) -> u16| {
        let units = rest.chunks_exact(2).filter_map(|pair| pair.try_into().ok());
        let is_whole = rest.len().is_multiple_of(2);
        let text: Result<String, _> = char::decode_utf16(units.map(unit)).collect();
        text.ok().filter(|_| is_whole)
    };
    let text = match bytes {
        [0xFF, 0xFE, rest @ ..] => utf_16(rest, u16::from_le_bytes),
        [0xFE, 0xFF, rest @ ..] => utf_16(rest, u16::from_be_bytes),
        _ => std::str::from_utf8(bytes).ok().map(ToOwned::to_owned),
    };
    let text = text.filter(|text| !text.contains('\0'));
    text.ok_or_else(|| SequenceError::at("", Problem::NotText))
}

/// Separator and decimal mark.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dialect {
    pub(super) delimiter: u8,
    /// Whether a field has a comma: then a point is no decimal mark.
    has_commas: bool,
}

impl Dialect {
    /// The dialect of a text, the rest of the text behind the line `sep=;` of Excel, and the number of lines before it.
    pub(super) fn of(text: &str) -> (Self, &str, usize) {
        let text = text.trim_start_matches('\u{FEFF}');
        let (first, rest) = text.split_once('\n').unwrap_or((text, ""));
        let named = first
            .trim_end()
            .strip_prefix("sep=")
            .and_then(|sep| sep.bytes().next());
        let (rest, before) = if named.is_some() {
            (rest, 1)
        } else {
            (text, 0)
        };
        let head = rest.lines().next().unwrap_or_default();
        let delimiter = named.unwrap_or(if head.contains('\t') {
            b'\t'
        } else if head.contains(';') {
            b';'
        } else {
            b','
        });
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
