//! Imports setpoints from a CSV file: a column of times, and setpoints for each motor.
//!
//! | module | idea |
//! |---|---|
//! | `dialect` | encoding, separator and decimal mark |
//! | `rows` | the rows, in bounded memory |
//! | `columns` | what the columns are |

mod columns;
mod dialect;
mod rows;

use motorlink_protocol::{Acceleration, MotorId, SpeedTarget};

pub use dialect::{Decoder, separator_of, text_of};

use super::{
    AMPS_MAX, Action, DEGREES_MAX, End, Move, Problem, Quantity, STEPS_MAX, Selection, Sequence,
    SequenceError, Shape, Step,
};
use columns::{Columns, PlotColumn};
use dialect::Dialect;
use rows::Rows;

/// Reads a file such as this one:
///
/// ```csv
/// time_s,1 rpm,2 rpm
/// 0,0,0
/// 0.5,100,-100
/// 2.5,0,0
/// ```
///
/// The first column, `time_s` or `time`, is the time from the start in seconds. The name of another column is the number
/// of a motor and `rpm`, `amps` or `degrees`; without a number it applies to all motors. An empty cell changes nothing.
/// Commas, semicolons or tabs separate the columns; a comma that does not is a decimal mark. The file of a run
/// ([`record_to_csv`](crate::kept::record_to_csv)) is read as the setpoints that were sent, and so is the file for plotting
/// of a recording. That has the motors' own signs: speeds and currents of the `mirrored` motors are turned, so that + is
/// forward as in every sequence.
///
/// # Errors
/// [`SequenceError`] names the place by line and column, as in `line 3, column 2`.
pub fn from_csv(text: &str, mirrored: &[MotorId]) -> Result<Sequence, SequenceError> {
    let (dialect, text, before) = Dialect::of(text);
    let mut rows = Rows::new(text, dialect.delimiter, before);
    let head = rows.next().transpose()?.unwrap_or_default();
    let mut read = Read {
        dialect,
        mirrored,
        columns: Columns::of(&head, before + 1)?,
        steps: Vec::new(),
        before: None,
        last: Vec::new(),
    };
    for (line, row) in (before + 2..).zip(rows) {
        read.row(&row?, line)?;
    }
    Ok(Sequence {
        steps: read.steps,
        ..Sequence::default()
    })
}

struct Read<'a> {
    dialect: Dialect,
    mirrored: &'a [MotorId],
    columns: Columns,
    steps: Vec<Step>,
    /// The time of the row before.
    before: Option<f64>,
    /// The last setpoint of each motor in the file of a run, which repeats it.
    last: Vec<(MotorId, Action)>,
}

impl Read<'_> {
    fn row(&mut self, row: &[String], line: usize) -> Result<(), SequenceError> {
        let Some((time, values)) = row.split_first() else {
            return Ok(());
        };
        let time = self.number(time, line, 1)?;
        let new = match &self.columns {
            Columns::Wide(columns) => {
                let width = columns.len();
                if values.len() > width {
                    return Err(at(line, width + 2, Problem::UnknownField));
                }
                self.check_time(time, line)?;
                self.setpoints(values, line)?
            }
            Columns::Run {
                motor,
                setpoint,
                unit,
            } => self
                .sent(row, line, [*motor, *setpoint, *unit])?
                .into_iter()
                .collect(),
            Columns::Plot(columns) => {
                let mut new = Vec::new();
                for column in columns.clone() {
                    new.extend(self.plotted(row, line, column)?);
                }
                new
            }
        };
        if !matches!(self.columns, Columns::Wide(_)) {
            // The run of the sequence begins with its first setpoint.
            if self.before.is_none() && new.is_empty() {
                return Ok(());
            }
            if self.before.is_some_and(|before| time < before) {
                return Err(at(line, 1, Problem::TimeFalls));
            }
        }
        // The previous row lasts until this one. The last row only ends the row before it.
        lengthen(&mut self.steps, time - self.before.unwrap_or(time));
        self.before = Some(time);
        if self.steps.len() + new.len() > STEPS_MAX {
            return Err(at(line, 1, Problem::TooManySteps { max: STEPS_MAX }));
        }
        self.steps.extend(new);
        Ok(())
    }

    fn check_time(&self, time: f64, line: usize) -> Result<(), SequenceError> {
        let problem = if time < 0.0 {
            Problem::Below {
                value: time,
                min: 0.0,
            }
        } else if self.before.is_some_and(|before| time <= before) {
            Problem::TimeFalls
        } else if self.before.is_none() && time > 0.0 {
            // The run begins with the first row.
            Problem::Above {
                value: time,
                max: 0.0,
            }
        } else if self.before.is_some() && self.steps.is_empty() {
            return Err(at(2, 2, Problem::Expected("a value in the first row")));
        } else {
            return Ok(());
        };
        Err(at(line, 1, problem))
    }

    /// The setpoints of a row with a column for each motor.
    fn setpoints(&self, values: &[String], line: usize) -> Result<Vec<Step>, SequenceError> {
        let Columns::Wide(columns) = &self.columns else {
            return Ok(Vec::new());
        };
        let mut new = Vec::new();
        for (place, (value, column)) in (2..).zip(values.iter().zip(columns)) {
            if !value.trim().is_empty() {
                let value = self.setpoint(value, column.quantity, line, place)?;
                new.push(Step::hold(
                    column.selection.clone(),
                    column.quantity,
                    value,
                    0.0,
                ));
            }
        }
        Ok(new)
    }

    /// The setpoint in a row of the file of a run, if it is another one than before.
    fn sent(
        &mut self,
        row: &[String],
        line: usize,
        [motor, setpoint, unit]: [usize; 3],
    ) -> Result<Option<Step>, SequenceError> {
        let cell = |place: usize| row.get(place).map_or("", |cell| cell.trim());
        if cell(setpoint).is_empty() {
            return Ok(None);
        }
        let id: MotorId = cell(motor)
            .parse()
            .map_err(|_| at(line, motor + 1, Problem::Expected("an ID from 1 to 254")))?;
        let follow = |quantity| -> Result<Action, SequenceError> {
            let to = self.setpoint(cell(setpoint), quantity, line, setpoint + 1)?;
            Ok(Action::Follow {
                quantity,
                shape: Shape::Step { to },
                acceleration: Acceleration::DEFAULT,
            })
        };
        let action = match cell(unit) {
            "rpm" => follow(Quantity::Rpm)?,
            "A" => follow(Quantity::Amps)?,
            "deg" => follow(Quantity::Degrees)?,
            "brake" => Action::Brake,
            _ => {
                let units = Problem::Expected("rpm, A, deg or brake");
                return Err(at(line, unit + 1, units));
            }
        };
        Ok(self.changed(id, action))
    }

    /// The setpoint of a motor in a row of a file for plotting, if it is another one than before.
    fn plotted(
        &mut self,
        row: &[String],
        line: usize,
        column: PlotColumn,
    ) -> Result<Option<Step>, SequenceError> {
        let PlotColumn {
            motor,
            setpoint,
            mode,
        } = column;
        let cell = |place: usize| row.get(place).map_or("", |cell| cell.trim());
        if cell(setpoint).is_empty() {
            return Ok(None);
        }
        let quantity = match cell(mode) {
            "1" => Quantity::Amps,
            "2" => Quantity::Rpm,
            "3" => Quantity::Degrees,
            _ => {
                let modes = Problem::Expected("the loop of the setpoint: 1, 2 or 3");
                return Err(at(line, mode + 1, modes));
            }
        };
        let value = self.setpoint(cell(setpoint), quantity, line, setpoint + 1)?;
        let is_turned = quantity != Quantity::Degrees && self.mirrored.contains(&motor);
        // No negative zero.
        let to = if is_turned { 0.0 - value } else { value };
        let action = Action::Follow {
            quantity,
            shape: Shape::Step { to },
            acceleration: Acceleration::DEFAULT,
        };
        Ok(self.changed(motor, action))
    }

    /// A step with this action, if the last one of the motor was another.
    fn changed(&mut self, id: MotorId, action: Action) -> Option<Step> {
        let place = self.last.iter().position(|(known, _)| *known == id);
        match place.and_then(|place| self.last.get_mut(place)) {
            Some((_, last)) if *last == action => return None,
            Some((_, last)) => *last = action,
            None => self.last.push((id, action)),
        }
        Some(Step::Move(Move {
            selection: Selection::Motor(id),
            action,
            end: End::After(0.0),
        }))
    }

    /// A setpoint that some motor can have; the plan checks it for those that are there.
    fn setpoint(
        &self,
        text: &str,
        quantity: Quantity,
        line: usize,
        column: usize,
    ) -> Result<f64, SequenceError> {
        let value = self.number(text, line, column)?;
        let (min, max) = match quantity {
            Quantity::Rpm => (f64::from(SpeedTarget::MIN), f64::from(SpeedTarget::MAX)),
            Quantity::Amps => (-AMPS_MAX, AMPS_MAX),
            Quantity::Degrees => (0.0, DEGREES_MAX),
        };
        let problem = if value > max {
            Problem::Above { value, max }
        } else if value < min {
            Problem::Below { value, min }
        } else {
            return Ok(value);
        };
        Err(at(line, column, problem))
    }

    fn number(&self, text: &str, line: usize, column: usize) -> Result<f64, SequenceError> {
        let number = self.dialect.number(text);
        number.map_err(|problem| at(line, column, problem))
    }
}

fn lengthen(steps: &mut [Step], seconds: f64) {
    if let Some(Step::Move(last)) = steps.last_mut()
        && let End::After(time) = &mut last.end
    {
        *time += seconds;
    }
}

fn at(line: usize, column: usize, problem: Problem) -> SequenceError {
    SequenceError::at(format!("line {line}, column {column}"), problem)
}
