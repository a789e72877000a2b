//! Writes cells and lines with the `csv` crate, in reused buffers.

use csv::ByteRecord;
use csv_core::{Terminator, WriterBuilder};

use crate::charset::spell_out;

/// A spreadsheet treats a text that begins with one of these as a formula, or may do so after trimming; the
/// wide ones where the user writes Chinese or Japanese. Source: OWASP, "CSV Injection".
const FORMULA_STARTS: [char; 11] = [
    '=', '+', '-', '@', '\t', '\r', '\n', '\u{FF1D}', '\u{FF0B}', '\u{FF0D}', '\u{FF20}',
];

/// What a spreadsheet may trim; tabs and line ends are [`FORMULA_STARTS`] themselves.
const SPACES: [char; 3] = [' ', '\u{A0}', '\u{3000}'];

/// Precedes a text that a spreadsheet could run. No program takes a cell that begins with a letter for a
/// formula, and [`unmarked`] finds the text again. (An apostrophe would show in every program but the one
/// that its user types it into.)
const MARK: &str = "text: ";

/// Builds one line cell by cell, in reused buffers.
#[derive(Debug, Default)]
pub(crate) struct Cells {
    line: ByteRecord,
    cell: String,
    spelled: String,
}

impl Cells {
    /// Adds a cell unchanged.
    #[inline(never)]
    pub(crate) fn plain(&mut self, cell: &str) {
        self.line.push_field(cell.as_bytes());
    }

    /// Adds the names of columns.
    pub(crate) fn names(&mut self, names: &[&str]) {
        for name in names {
            self.plain(name);
        }
    }

    /// Adds a cell with a number, a time or hex: never a formula, even if it begins with a minus.
    pub(crate) fn value(&mut self, write: impl FnOnce(&mut String)) {
        self.cell.clear();
        write(&mut self.cell);
        self.end_cell();
    }

    /// Adds a cell with any text, in ASCII if possible, and marked if a spreadsheet could run it.
    pub(crate) fn text(&mut self, write: impl FnOnce(&mut String)) {
        self.cell.clear();
        write(&mut self.cell);
        self.end_text();
    }

    #[inline(never)]
    fn end_text(&mut self) {
        spell_out(&mut self.cell, &mut self.spelled);
        if needs_mark(&self.cell) {
            self.cell.insert_str(0, MARK);
        }
        self.end_cell();
    }

    /// One function for every kind of cell: it is called in some forty places.
    #[inline(never)]
    fn end_cell(&mut self) {
        self.line.push_field(self.cell.as_bytes());
    }

    /// Adds an empty cell, for an unknown value.
    pub(crate) fn unknown(&mut self) {
        self.plain("");
    }

    /// Adds a value, or an empty cell if it is unknown.
    pub(crate) fn known<T>(&mut self, value: Option<T>, push: impl FnOnce(&mut String, T)) {
        match value {
            Some(value) => self.value(|out| push(out, value)),
            None => self.unknown(),
        }
    }

    /// Adds the line to a file, by RFC 4180.
    #[inline(never)]
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

/// Whether a text is written behind [`MARK`]: a spreadsheet could run it, or a reader could take its beginning
/// for a mark.
fn needs_mark(text: &str) -> bool {
    text.starts_with(MARK)
        || text.starts_with('\'')
        || text.trim_start_matches(SPACES).starts_with(FORMULA_STARTS)
}

/// The text of a cell of the packet log: without its mark, or without the apostrophe that earlier versions
/// wrote instead.
#[must_use]
pub fn unmarked(cell: &str) -> &str {
    let text = cell.strip_prefix(MARK).filter(|text| needs_mark(text));
    let was_run = |text: &&str| text.starts_with(FORMULA_STARTS);
    let text = text.or_else(|| cell.strip_prefix('\'').filter(was_run));
    text.unwrap_or(cell)
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
    fn what_a_spreadsheet_would_run_is_marked_as_text() {
        for (text, cell) in [
            ("=1+1", "text: =1+1\r\n"),
            ("+100 rpm", "text: +100 rpm\r\n"),
            ("-2", "text: -2\r\n"),
            ("@SUM(A1)", "text: @SUM(A1)\r\n"),
            ("\t=1", "text: \t=1\r\n"),
            ("\r=1", "\"text: \r=1\"\r\n"),
            ("\n=1", "\"text: \n=1\"\r\n"),
            (" =1", "text:  =1\r\n"),
            ("\u{3000}\u{FF1D}1", "text: \u{3000}\u{FF1D}1\r\n"),
            (
                "=HYPERLINK(\"a\",\"b\")",
                "\"text: =HYPERLINK(\"\"a\"\",\"\"b\"\")\"\r\n",
            ),
            ("Ω\u{2212}1", "Ω\u{2212}1\r\n"),
            ("1=1", "1=1\r\n"),
            ("text: a", "text: text: a\r\n"),
            ("'=1", "text: '=1\r\n"),
        ] {
            let written = line(|cells| cells.text(|out| out.push_str(text)));
            assert_eq!(written, cell, "{text:?}");
            let record = csv::ReaderBuilder::new()
                .has_headers(false)
                .from_reader(cell.as_bytes())
                .records()
                .next();
            assert_eq!(unmarked(&record.unwrap().unwrap()[0]), text);
        }
    }

    #[test]
    fn the_apostrophe_of_earlier_versions_is_removed() {
        assert_eq!(unmarked("'+100 rpm"), "+100 rpm");
        assert_eq!(unmarked("'s"), "'s");
        assert_eq!(unmarked("text: a"), "text: a", "it was written so");
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
