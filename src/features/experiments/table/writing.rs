//! From a sequence to rows.

use motorlink_messages::experiments::sequence::{
    Action, Condition, End, Move, Quantity, Selection, Sequence, Shape, Step,
};

use super::{Column, Kind, Row};

impl Row {
    /// The step of a new row: 50 rpm for 2 s.
    pub(in crate::features::experiments) fn new_step() -> Self {
        let step = Step::hold(Selection::All, Quantity::Rpm, 50.0, 2.0);
        let mut rows = Vec::new();
        add_rows(&step, &mut rows);
        rows.pop().unwrap_or_default()
    }

    /// The rows of a new repeat, with one step.
    pub(in crate::features::experiments) fn new_repeat() -> [Self; 3] {
        let row = |kind| Self {
            kind,
            ..Self::default()
        };
        let head = row(Kind::Repeat).with(Column::Passes, "5");
        [until(head, None), Self::new_step(), row(Kind::EndRepeat)]
    }
}

/// The rows of a sequence.
pub(in crate::features::experiments) fn rows(sequence: &Sequence) -> Vec<Row> {
    let mut rows = Vec::new();
    for step in &sequence.steps {
        add_rows(step, &mut rows);
    }
    rows
}

fn add_rows(step: &Step, rows: &mut Vec<Row>) {
    match step {
        Step::Move(step) => rows.push(move_row(step)),
        Step::Repeat(repeat) => {
            let row = Row {
                kind: Kind::Repeat,
                ..Row::default()
            };
            let row = row.with(Column::Passes, &repeat.passes.to_string());
            rows.push(until(row, repeat.until));
            for step in &repeat.steps {
                add_rows(step, rows);
            }
            rows.push(Row {
                kind: Kind::EndRepeat,
                ..Row::default()
            });
        }
    }
}

fn until(row: Row, condition: Option<Condition>) -> Row {
    let (name, bound, tolerance) = match condition {
        None => return row.with(Column::Until, "time"),
        Some(Condition::RpmAbove(bound)) => ("rpm_above", bound, None),
        Some(Condition::RpmBelow(bound)) => ("rpm_below", bound, None),
        Some(Condition::CelsiusAbove(bound)) => ("celsius_above", bound, None),
        Some(Condition::CelsiusBelow(bound)) => ("celsius_below", bound, None),
        Some(Condition::DegreesNear { degrees, tolerance }) => {
            ("degrees", degrees, Some(tolerance))
        }
    };
    let row = row
        .with(Column::Until, name)
        .with(Column::Bound, &bound.to_string());
    match tolerance {
        Some(tolerance) => row.with(Column::Tolerance, &tolerance.to_string()),
        None => row,
    }
}

fn move_row(step: &Move) -> Row {
    let motors = match &step.selection {
        Selection::All => "all".to_owned(),
        Selection::Motor(id) => id.get().to_string(),
        Selection::Group(name) => format!("group {name}"),
    };
    let row = Row::default().with(Column::Motors, &motors);
    let row = match step.action {
        Action::Brake => row.with(Column::Quantity, "brake"),
        Action::Follow {
            quantity,
            shape,
            acceleration,
        } => {
            let row = row
                .with(Column::Quantity, quantity.field())
                .with(Column::Shape, shape.name())
                .with(Column::Acceleration, &acceleration.byte().to_string());
            let (value, wave, to_hz) = match shape {
                Shape::Step { to } | Shape::Ramp { to } => (to, None, None),
                Shape::Sine(wave) | Shape::Triangle(wave) => (wave.centre, Some(wave), None),
                Shape::Chirp { wave, to_hz } => (wave.centre, Some(wave), Some(to_hz)),
            };
            let mut row = row.with(Column::Value, &value.to_string());
            if let Some(wave) = wave {
                row.set(Column::Amplitude, &wave.amplitude.to_string());
                row.set(Column::Hz, &wave.hz.to_string());
            }
            if let Some(to_hz) = to_hz {
                row.set(Column::ToHz, &to_hz.to_string());
            }
            row
        }
    };
    match step.end {
        End::After(seconds) => until(row, None).with(Column::Seconds, &seconds.to_string()),
        End::Until {
            condition,
            within_s,
        } => until(row, Some(condition)).with(Column::Seconds, &within_s.to_string()),
    }
}
