//! Imports setpoints from a CSV file: a column of times, and one of setpoints for each motor.

use csv_core::{ReadFieldResult, Reader, ReaderBuilder};
use motorlink_protocol::MotorId;

use super::{Problem, Quantity, STEPS_MAX, Selection, Sequence, SequenceError, Step};

/// Maximal length of a field: a number with every digit that a spreadsheet writes.
const FIELD_MAX: usize = 64;
/// Maximal number of columns: the time and one per motor.
const COLUMNS_MAX: usize = 17;

/// A column of setpoints.
struct Column {
    selection: Selection,
    quantity: Quantity,
}

/// Reads a file such as this one:
///
/// ```csv
/// time_s,1 rpm,2 rpm
/// 0,0,0
/// 0.5,100,-100
/// 2.5,0,0
/// ```
///
/// The first column is the time from the start in seconds. The name of another column is the number of a motor and
/// `rpm`, `amps` or `degrees`; without a number it applies to all motors. An empty cell changes nothing. If
/// semicolons separate the columns, a comma is a decimal mark.
///
/// # Errors
/// [`SequenceError`] names the place by line and column, as in `line 3, column 2`.
pub fn from_csv(text: &str) -> Result<Sequence, SequenceError> {
    let text = text.trim_start_matches('\u{FEFF}');
    let semicolons = text
        .lines()
        .next()
        .is_some_and(|line| line.contains(';') && !line.contains(','));
    let mut rows = Rows::new(text, semicolons);
    let head = rows.next().transpose()?.unwrap_or_default();
    let columns = head_columns(&head)?;
    let mut steps: Vec<Step> = Vec::new();
    let mut before: Option<f64> = None;
    for (line, row) in (2..).zip(rows) {
        let row = row?;
        let Some((time, values)) = row.split_first() else {
            continue;
        };
        let time = number(time, semicolons, line, 1)?;
        if time < 0.0 {
            return Err(at(
                line,
                1,
                Problem::Below {
                    value: time,
                    min: 0.0,
                },
            ));
        }
        if before.is_some_and(|before| time <= before) {
            return Err(at(line, 1, Problem::TimeFalls));
        }
        // The run begins with the first row.
        if before.is_none() && time > 0.0 {
            let problem = Problem::Above {
                value: time,
                max: 0.0,
            };
            return Err(at(line, 1, problem));
        }
        // The previous row lasts until this one. The last row only ends the row before it.
        if before.is_some() && steps.is_empty() {
            return Err(at(2, 2, Problem::Expected("a value in the first row")));
        }
        lengthen(&mut steps, time - before.unwrap_or(time));
        before = Some(time);
        for (place, (value, column)) in values.iter().zip(&columns).enumerate() {
            if value.trim().is_empty() {
                continue;
            }
            if steps.len() >= STEPS_MAX {
                return Err(at(line, 1, Problem::TooManySteps { max: STEPS_MAX }));
            }
            let value = number(value, semicolons, line, place + 2)?;
            steps.push(Step::hold(
                column.selection.clone(),
                column.quantity,
                value,
                0.0,
            ));
        }
        if values.len() > columns.len() {
            return Err(at(line, columns.len() + 2, Problem::UnknownField));
        }
    }
    Ok(Sequence {
        steps,
        ..Sequence::default()
    })
}

fn lengthen(steps: &mut [Step], seconds: f64) {
    if let Some(Step::Move(last)) = steps.last_mut()
        && let super::End::After(time) = &mut last.end
    {
        *time += seconds;
    }
}

fn head_columns(head: &[String]) -> Result<Vec<Column>, SequenceError> {
    let wrong = |column| {
        let names = Problem::Expected("time_s first, then columns such as rpm or \"1 rpm\"");
        at(1, column, names)
    };
    let Some((time, rest)) = head.split_first() else {
        return Err(wrong(1));
    };
    if time.trim() != "time_s" || rest.is_empty() {
        return Err(wrong(1));
    }
    let column = |(place, name): (usize, &String)| {
        let name = name.trim();
        let (selection, quantity) = match name.rsplit_once(' ') {
            None => (Selection::All, name),
            Some((motor, quantity)) => {
                let id: Result<MotorId, _> = motor.trim().parse();
                (
                    Selection::Motor(id.map_err(|_| wrong(place + 2))?),
                    quantity,
                )
            }
        };
        let mut all = Quantity::ALL.into_iter();
        let quantity = all.find(|known| known.field() == quantity);
        let quantity = quantity.ok_or_else(|| wrong(place + 2))?;
        Ok(Column {
            selection,
            quantity,
        })
    };
    rest.iter().enumerate().map(column).collect()
}

fn number(
    text: &str,
    decimal_comma: bool,
    line: usize,
    column: usize,
) -> Result<f64, SequenceError> {
    let text = text.trim();
    let number = if decimal_comma {
        text.replace(',', ".").parse::<f64>()
    } else {
        text.parse::<f64>()
    };
    let finite = number.ok().filter(|number| number.is_finite());
    finite.ok_or_else(|| at(line, column, Problem::Expected("a number")))
}

fn at(line: usize, column: usize, problem: Problem) -> SequenceError {
    SequenceError::at(format!("line {line}, column {column}"), problem)
}

/// The rows of a file, without empty ones.
struct Rows<'a> {
    reader: Reader,
    rest: &'a [u8],
    line: usize,
    ended: bool,
}

impl<'a> Rows<'a> {
    fn new(text: &'a str, semicolons: bool) -> Self {
        let delimiter = if semicolons { b';' } else { b',' };
        Self {
            reader: ReaderBuilder::new().delimiter(delimiter).build(),
            rest: text.as_bytes(),
            line: 0,
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
                        let problem = Problem::TooManyMotors {
                            max: COLUMNS_MAX - 1,
                        };
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
