//! Writes cells and lines with the `csv` crate, in reused buffers.

use csv::ByteRecord;
use csv_core::{Terminator, WriterBuilder};

/// A spreadsheet treats a text that begins with one of these as a formula, or may do so after trimming.
/// Source: OWASP, "CSV Injection".
const FORMULA_STARTS: [char; 7] = ['=', '+', '-', '@', '\t', '\r', '\n'];

/// Builds one line cell by cell, in reused buffers.
#[derive(Debug, Default)]
pub(crate) struct Cells {
    line: ByteRecord,
    cell: String,
}

impl Cells {
    /// Adds a cell unchanged.
    pub(crate) fn plain(&mut self, cell: &str) {
        self.line.push_field(cell.as_bytes());
    }

    /// Adds a cell with a number, a time or hex: never a formula, even if it begins with a minus.
    pub(crate) fn value(&mut self, write: impl FnOnce(&mut String)) {
        self.cell.clear();
        write(&mut self.cell);
        self.line.push_field(self.cell.as_bytes());
    }

    /// Adds a cell with a text. A spreadsheet would run a text that looks like a formula, such as `+100 rpm`:
    /// a leading apostrophe prevents that.
    pub(crate) fn text(&mut self, write: impl FnOnce(&mut String)) {
        self.value(|cell| {
            write(cell);
            if cell.starts_with(FORMULA_STARTS) {
                cell.insert(0, '\'');
            }
        });
    }

    /// Adds an empty cell, for an unknown value.
    pub(crate) fn unknown(&mut self) {
        self.plain("");
    }

    /// Adds the line to a file, by RFC 4180.
    pub(crate) fn end_line(&mut self, out: &mut Vec<u8>) {
        let mut separator: &[u8] = b"";
        for cell in &self.line {
            out.extend_from_slice(separator);
            push_quoted(out, cell);
            separator = b",";
        }
        out.extend_from_slice(b"\r\n");
        self.line.clear();
    }
}

/// Adds one cell, in quotes if it needs them.
///
/// `csv::Writer` does the same. But with it the compiler cannot see that quotes are added only where needed,
/// and keeps the style that quotes all but numbers. That style parses floats, with tables of 17 kB gzipped,
/// a fifteenth of a first visit. Here the compiler removes them.
#[inline(never)]
fn push_quoted(out: &mut Vec<u8>, cell: &[u8]) {
    // The writer would treat it as a line with one empty cell, which needs quotes.
    if cell.is_empty() {
        return;
    }
    let start = out.len();
    // In the worst case every byte is a quote and doubled, between two quotes.
    out.resize(start + 2 * cell.len() + 2, 0);
    let mut writer = WriterBuilder::new().terminator(Terminator::CRLF).build();
    let mut length = 0;
    if let Some(room) = out.get_mut(start..) {
        let (_, _, written) = writer.field(cell, room);
        let room = room.get_mut(written..).unwrap_or_default();
        let (_, closing) = writer.finish(room);
        length = written + closing;
    }
    out.truncate(start + length);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(write: impl FnOnce(&mut Cells)) -> String {
        let mut cells = Cells::default();
        let mut out = Vec::new();
        write(&mut cells);
        cells.end_line(&mut out);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn what_a_spreadsheet_would_run_is_made_text() {
        for (text, cell) in [
            ("=1+1", "'=1+1\r\n"),
            ("+100 rpm", "'+100 rpm\r\n"),
            ("-2", "'-2\r\n"),
            ("@SUM(A1)", "'@SUM(A1)\r\n"),
            ("\t=1", "'\t=1\r\n"),
            ("\r=1", "\"'\r=1\"\r\n"),
            ("\n=1", "\"'\n=1\"\r\n"),
            (
                "=HYPERLINK(\"a\",\"b\")",
                "\"'=HYPERLINK(\"\"a\"\",\"\"b\"\")\"\r\n",
            ),
            ("\u{2212}100 rpm", "\u{2212}100 rpm\r\n"),
            ("1=1", "1=1\r\n"),
            (" =1", " =1\r\n"),
        ] {
            let written = line(|cells| cells.text(|out| out.push_str(text)));
            assert_eq!(written, cell, "{text:?}");
        }
    }

    #[test]
    fn numbers_stay_numbers() {
        let written = line(|cells| {
            cells.value(|out| out.push_str("-100"));
            cells.value(|out| out.push_str("-0.250"));
            cells.unknown();
            cells.plain("OK");
        });
        assert_eq!(written, "-100,-0.250,,OK\r\n");
    }

    /// Byte for byte what the writer of the `csv` crate makes of the same cells.
    #[test]
    fn lines_are_those_of_the_csv_crate() {
        let cells = [
            "", "a", "a,b", "\"", "\"\"a\"", "a\r\nb", "\n", " a ", "1.5", "°", "a\tb", "'",
        ];
        let mut writer = csv::WriterBuilder::new()
            .terminator(csv::Terminator::CRLF)
            .from_writer(Vec::new());
        writer.write_record(cells).unwrap();
        let expected = String::from_utf8(writer.into_inner().unwrap()).unwrap();
        let written = line(|line| cells.iter().for_each(|cell| line.plain(cell)));
        assert_eq!(written, expected);
    }
}
