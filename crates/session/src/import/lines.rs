//! Splits a CSV file into lines with `csv-core`, in bounded memory.

use csv_core::{ReadRecordResult, Reader, ReaderBuilder};

/// Maximal bytes per line. The longest texts of the page have a thousand.
const LINE_BYTES_MAX: usize = 8 << 10;

/// Maximal cells per line. The widest file has ten.
const CELLS_MAX: usize = 32;

/// Assembles lines.
#[derive(Debug)]
pub(super) struct Lines {
    reader: Reader,
    text: Vec<u8>,
    ends: Vec<usize>,
    text_len: usize,
    cells: usize,
    /// The current line exceeds a maximum.
    is_too_long: bool,
}

impl Lines {
    /// Lines whose cells this byte separates.
    pub(super) fn new(separator: u8) -> Self {
        Self {
            reader: ReaderBuilder::new().delimiter(separator).build(),
            text: vec![0; LINE_BYTES_MAX],
            ends: vec![0; CELLS_MAX],
            text_len: 0,
            cells: 0,
            is_too_long: false,
        }
    }

    /// Takes bytes, and passes every completed line to `line`: `None` if it is too long or not UTF-8. The last line need have
    /// no line break.
    pub(super) fn feed(
        &mut self,
        bytes: &[u8],
        is_last: bool,
        mut line: impl FnMut(Option<&[&str]>),
    ) {
        let mut rest = bytes;
        let mut has_ended = !is_last;
        while !rest.is_empty() || !has_ended {
            let (ended, read) = self.step(rest, &mut line);
            has_ended |= ended;
            rest = rest.get(read..).unwrap_or_default();
        }
    }

    /// Returns whether the file has ended, and how many bytes were read.
    fn step(&mut self, bytes: &[u8], line: &mut impl FnMut(Option<&[&str]>)) -> (bool, usize) {
        let text = self.text.get_mut(self.text_len..).unwrap_or_default();
        let ends = self.ends.get_mut(self.cells..).unwrap_or_default();
        let (result, read, written, cells) = self.reader.read_record(bytes, text, ends);
        self.text_len += written;
        self.cells += cells;
        match result {
            ReadRecordResult::InputEmpty => {}
            ReadRecordResult::OutputFull | ReadRecordResult::OutputEndsFull => {
                self.is_too_long = true;
                (self.text_len, self.cells) = (0, 0);
            }
            ReadRecordResult::Record => {
                let cells = self.cells();
                line(cells.as_deref().filter(|_| !self.is_too_long));
                self.is_too_long = false;
                (self.text_len, self.cells) = (0, 0);
            }
            ReadRecordResult::End => return (true, read),
        }
        (false, read)
    }

    fn cells(&self) -> Option<Vec<&str>> {
        let mut start = 0;
        let ends = self.ends.get(..self.cells)?;
        ends.iter()
            .map(|end| {
                let cell = self.text.get(start..*end)?;
                start = *end;
                std::str::from_utf8(cell).ok()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8], piece: usize) -> Vec<Option<Vec<String>>> {
        let mut lines = Lines::new(b',');
        let mut read = Vec::new();
        let mut keep = |cells: Option<&[&str]>| {
            read.push(cells.map(|cells| cells.iter().map(|cell| (*cell).to_owned()).collect()));
        };
        for piece in text.chunks(piece) {
            lines.feed(piece, false, &mut keep);
        }
        lines.feed(&[], true, &mut keep);
        read
    }

    #[test]
    fn lines_are_read_in_pieces_of_any_size() {
        let text = "a,\"b\"\"\nc\",\r\n1,2,°";
        for piece in 1..text.len() {
            let expected = [["a", "b\"\nc", ""], ["1", "2", "°"]];
            let expected = expected.map(|line| Some(line.map(str::to_owned).to_vec()));
            assert_eq!(read(text.as_bytes(), piece), expected);
        }
    }

    #[test]
    fn a_line_that_is_too_long_is_skipped() {
        let long = "x".repeat(3 * LINE_BYTES_MAX);
        let many = ",".repeat(3 * CELLS_MAX);
        let text = format!("a\n{long}\nb\n{many}\nc\n\"{long}");
        let lines = read(text.as_bytes(), 1_000);
        let known: Vec<_> = lines
            .iter()
            .map(|line| line.as_ref().map(|line| line[0].clone()))
            .collect();
        let some = |text: &str| Some(text.to_owned());
        assert_eq!(known, [some("a"), None, some("b"), None, some("c"), None]);
        assert_eq!(read(b"\xFF\n", 1), [None]);
        assert!(read(b"", 1).is_empty());
    }
}
