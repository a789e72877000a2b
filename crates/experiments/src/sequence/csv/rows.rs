//! The rows of a CSV file, in bounded memory.

use csv_core::{ReadFieldResult, Reader, ReaderBuilder};

use super::at;
use crate::plan::MOTORS_MAX;
use crate::sequence::{Problem, SequenceError};

/// Maximal length of a field: a number with every digit that a spreadsheet writes.
const FIELD_MAX: usize = 64;
/// Maximal number of columns: the time, and eight for each motor in a file for plotting.
const COLUMNS_MAX: usize = 1 + 8 * MOTORS_MAX;

/// The rows of a file, without empty ones.
pub(super) struct Rows<'a> {
    reader: Reader,
    rest: &'a [u8],
    line: usize,
    ended: bool,
}

impl<'a> Rows<'a> {
    /// The rows of this text, which begins after so many lines of the file.
    pub(super) fn new(text: &'a str, delimiter: u8, line: usize) -> Self {
        Self {
            reader: ReaderBuilder::new().delimiter(delimiter).build(),
            rest: text.as_bytes(),
            line,
            ended: false,
        }
    }
}

impl Iterator for Rows<'_> {
    type Item = Result<Vec<String>, SequenceError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        self.line += 1;
        let mut row = Vec::new();
        loop {
            let mut field = [0; FIELD_MAX];
            let (result, read, written) = self.reader.read_field(self.rest, &mut field);
            self.rest = self.rest.get(read..).unwrap_or_default();
            match result {
                // Without remaining input the next call ends the last row.
                ReadFieldResult::InputEmpty if written == 0 => {}
                ReadFieldResult::InputEmpty => {
                    // The last line has no line break: the written bytes belong to its last field.
                    let text = field.get(..written).unwrap_or_default();
                    row.push(String::from_utf8_lossy(text).into_owned());
                    self.ended = true;
                    return Some(Ok(row));
                }
                ReadFieldResult::OutputFull => {
                    self.ended = true;
                    let problem = Problem::Expected("a number");
                    return Some(Err(at(self.line, row.len() + 1, problem)));
                }
                ReadFieldResult::Field { record_end } => {
                    let text = field.get(..written).unwrap_or_default();
                    row.push(String::from_utf8_lossy(text).into_owned());
                    if row.len() > COLUMNS_MAX {
                        self.ended = true;
                        let problem = Problem::TooManyMotors { max: MOTORS_MAX };
                        return Some(Err(at(self.line, row.len(), problem)));
                    }
                    if record_end {
                        return Some(Ok(row));
                    }
                }
                ReadFieldResult::End => {
                    self.ended = true;
                    return (!row.is_empty()).then_some(Ok(row));
                }
            }
        }
    }
}
