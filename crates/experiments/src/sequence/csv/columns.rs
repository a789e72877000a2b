//! What the columns of a CSV file are.

use motorlink_protocol::MotorId;

use super::at;
use crate::plan::MOTORS_MAX;
use crate::sequence::{Problem, Quantity, Selection, SequenceError};

/// The setpoints of a row.
pub(super) enum Columns {
    /// Behind the time a column for each motor.
    Wide(Vec<Column>),
    /// The file of a run: columns with the motor, its setpoint and the unit.
    Run {
        motor: usize,
        setpoint: usize,
        unit: usize,
    },
    /// The file for plotting of a recording: behind the time two columns for each motor.
    Plot(Vec<PlotColumn>),
}

/// The columns of a motor in a file for plotting.
#[derive(Clone, Copy)]
pub(super) struct PlotColumn {
    pub(super) motor: MotorId,
    pub(super) setpoint: usize,
    pub(super) mode: usize,
}

/// A column of setpoints.
pub(super) struct Column {
    pub(super) selection: Selection,
    pub(super) quantity: Quantity,
}

impl Columns {
    /// The columns with these names, in this line of the file.
    pub(super) fn of(head: &[String], line: usize) -> Result<Self, SequenceError> {
        let wrong = |column| {
            let names = Problem::Expected("time_s first, then columns such as rpm or \"1 rpm\"");
            at(line, column, names)
        };
        let names: Vec<&str> = head.iter().map(|name| name.trim()).collect();
        let Some((&"time_s" | &"time", rest)) = names.split_first() else {
            return Err(wrong(1));
        };
        let find = |name: &str| names.iter().position(|known| *known == name);
        if let (Some(motor), Some(setpoint), Some(unit)) =
            (find("motor"), find("setpoint"), find("setpoint_unit"))
        {
            return Ok(Self::Run {
                motor,
                setpoint,
                unit,
            });
        }
        let plot: Vec<PlotColumn> = names
            .iter()
            .enumerate()
            .filter_map(|(setpoint, name)| {
                let motor = name.strip_prefix("motor_")?.strip_suffix("_setpoint")?;
                // Files of before do not name the sign.
                let motor = motor.strip_suffix("_unmirrored").unwrap_or(motor);
                Some(PlotColumn {
                    motor: motor.parse().ok()?,
                    setpoint,
                    mode: find(&format!("motor_{motor}_setpoint_mode"))?,
                })
            })
            .collect();
        if !plot.is_empty() {
            return Ok(Self::Plot(plot));
        }
        if rest.is_empty() {
            return Err(wrong(1));
        }
        if rest.len() > MOTORS_MAX {
            let max = MOTORS_MAX;
            return Err(at(line, max + 2, Problem::TooManyMotors { max }));
        }
        let mut columns: Vec<Column> = Vec::new();
        for (place, name) in (2..).zip(rest) {
            let column = column(name).ok_or_else(|| wrong(place))?;
            if columns.iter().any(|other| other.concerns(&column)) {
                return Err(at(line, place, Problem::Twice));
            }
            columns.push(column);
        }
        Ok(Self::Wide(columns))
    }
}

impl Column {
    /// Whether both are setpoints of one motor.
    fn concerns(&self, other: &Self) -> bool {
        let (one, other) = (&self.selection, &other.selection);
        one == other || *one == Selection::All || *other == Selection::All
    }
}

/// `rpm`, `1 rpm`
fn column(name: &str) -> Option<Column> {
    let (selection, quantity) = match name.rsplit_once(' ') {
        None => (Selection::All, name),
        Some((motor, quantity)) => {
            let id: MotorId = motor.trim().parse().ok()?;
            (Selection::Motor(id), quantity)
        }
    };
    let mut all = Quantity::ALL.into_iter();
    let quantity = all.find(|known| known.field() == quantity)?;
    Some(Column {
        selection,
        quantity,
    })
}
