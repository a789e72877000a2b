//! The table of steps as it is typed: a row for each step, for each repeat and for the end of each repeat.

use motorlink_messages::{
    experiments::sequence::{
        Action, Condition, End, Move, Problem, Quantity, Repeat, RunLimits, Selection, Sequence,
        SequenceError, Shape, Step, Wave,
    },
    protocol::{Acceleration, MotorId},
};

/// What a row is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    #[default]
    Move,
    Repeat,
    EndRepeat,
}

/// A column of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    /// `all`, the number of a motor, or `group` and a name.
    Motors,
    /// `rpm`, `amps`, `degrees` or `brake`.
    Quantity,
    Shape,
    Value,
    Amplitude,
    Hz,
    ToHz,
    Acceleration,
    /// `time`, or the condition.
    Until,
    Bound,
    Tolerance,
    Seconds,
    Passes,
}

impl Column {
    pub(super) const ALL: [Self; 13] = [
        Self::Motors,
        Self::Quantity,
        Self::Shape,
        Self::Value,
        Self::Amplitude,
        Self::Hz,
        Self::ToHz,
        Self::Acceleration,
        Self::Until,
        Self::Bound,
        Self::Tolerance,
        Self::Seconds,
        Self::Passes,
    ];

    /// Its key in the elements of the table.
    pub(super) const fn key(self) -> &'static str {
        match self {
            Self::Motors => "motors",
            Self::Quantity => "quantity",
            Self::Shape => "shape",
            Self::Value => "value",
            Self::Amplitude => "amplitude",
            Self::Hz => "hz",
            Self::ToHz => "to_hz",
            Self::Acceleration => "acceleration",
            Self::Until => "until",
            Self::Bound => "bound",
            Self::Tolerance => "tolerance",
            Self::Seconds => "seconds",
            Self::Passes => "passes",
        }
    }

    pub(super) fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|column| column.key() == key)
    }

    /// Whether its cells are lists: their change shows other cells.
    pub(super) const fn is_choice(self) -> bool {
        matches!(
            self,
            Self::Motors | Self::Quantity | Self::Shape | Self::Until
        )
    }

    /// The column of a field of a file.
    fn of_field(field: &str) -> Self {
        match field.split('.').next().unwrap_or_default() {
            "motor" | "group" => Self::Motors,
            "brake" => Self::Quantity,
            "shape" => Self::Shape,
            "amplitude" => Self::Amplitude,
            "hz" => Self::Hz,
            "to_hz" => Self::ToHz,
            "acceleration" => Self::Acceleration,
            "until" if field.ends_with("tolerance") => Self::Tolerance,
            "until" => Self::Bound,
            "for_s" | "within_s" => Self::Seconds,
            "repeat" => Self::Passes,
            _ => Self::Value,
        }
    }
}

/// A row as it is typed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Row {
    pub(super) kind: Kind,
    cells: [String; Column::ALL.len()],
}

/// The ends of a step in the list of a row: by time, and by each condition.
pub(super) const ENDS: [&str; 6] = [
    "time",
    "rpm_above",
    "rpm_below",
    "degrees",
    "celsius_above",
    "celsius_below",
];
pub(super) const SHAPES: [&str; 5] = ["step", "ramp", "sine", "triangle", "chirp"];
pub(super) const QUANTITIES: [&str; 4] = ["rpm", "amps", "degrees", "brake"];

impl Row {
    pub(super) fn cell(&self, column: Column) -> &str {
        let cell = self.cells.get(column as usize);
        cell.map(String::as_str).unwrap_or_default()
    }

    pub(super) fn set(&mut self, column: Column, text: &str) {
        if let Some(cell) = self.cells.get_mut(column as usize) {
            text.trim().clone_into(cell);
        }
    }

    fn with(mut self, column: Column, text: &str) -> Self {
        self.set(column, text);
        self
    }

    /// The step of a new row: 50 rpm for 2 s.
    pub(super) fn new_step() -> Self {
        let step = Step::hold(Selection::All, Quantity::Rpm, 50.0, 2.0);
        let mut rows = Vec::new();
        add_rows(&step, &mut rows);
        rows.pop().unwrap_or_default()
    }

    /// The rows of a new repeat, with one step.
    pub(super) fn new_repeat() -> [Self; 3] {
        let row = |kind| Self {
            kind,
            ..Self::default()
        };
        let head = row(Kind::Repeat).with(Column::Passes, "5");
        [until(head, None), Self::new_step(), row(Kind::EndRepeat)]
    }

    /// Whether the row has a cell in this column.
    pub(super) fn has(&self, column: Column) -> bool {
        let waits = self.cell(Column::Until) != "time";
        match self.kind {
            Kind::EndRepeat => false,
            Kind::Repeat => match column {
                Column::Passes | Column::Until => true,
                Column::Bound => waits,
                Column::Tolerance => self.cell(Column::Until) == "degrees",
                _ => false,
            },
            Kind::Move => {
                let follows = self.cell(Column::Quantity) != "brake";
                let shape = self.cell(Column::Shape);
                match column {
                    Column::Motors | Column::Quantity | Column::Until | Column::Seconds => true,
                    Column::Shape | Column::Value => follows,
                    Column::Amplitude | Column::Hz => {
                        follows && matches!(shape, "sine" | "triangle" | "chirp")
                    }
                    Column::ToHz => follows && shape == "chirp",
                    Column::Acceleration => self.cell(Column::Quantity) == "rpm",
                    Column::Bound => waits,
                    Column::Tolerance => self.cell(Column::Until) == "degrees",
                    Column::Passes => false,
                }
            }
        }
    }

    /// Fills cells that a choice has shown and that are empty.
    pub(super) fn fill(&mut self) {
        for (column, text) in [
            (Column::Shape, "step"),
            (Column::Value, "0"),
            (Column::Amplitude, "10"),
            (Column::Hz, "1"),
            (Column::ToHz, "5"),
            (Column::Acceleration, "0"),
            (Column::Bound, "5"),
            (Column::Tolerance, "2"),
        ] {
            if self.has(column) && self.cell(column).is_empty() {
                self.set(column, text);
            }
        }
    }

    fn number(&self, column: Column, place: &str, field: &str) -> Result<f64, SequenceError> {
        let text = self.cell(column).replace(['\u{2212}', '–'], "-");
        let number: Option<f64> = text.replace(',', ".").parse().ok();
        number
            .filter(|number| number.is_finite())
            .ok_or_else(|| no_number(format!("{place}.{field}")))
    }

    fn condition(&self, place: &str) -> Result<Option<Condition>, SequenceError> {
        let name = self.cell(Column::Until);
        if name == "time" || name.is_empty() {
            return Ok(None);
        }
        let bound = self.number(Column::Bound, place, &format!("until.{name}"))?;
        Ok(Some(match name {
            "rpm_above" => Condition::RpmAbove(bound),
            "rpm_below" => Condition::RpmBelow(bound),
            "celsius_above" => Condition::CelsiusAbove(bound),
            "celsius_below" => Condition::CelsiusBelow(bound),
            _ => Condition::DegreesNear {
                degrees: bound,
                tolerance: self.number(Column::Tolerance, place, "until.tolerance")?,
            },
        }))
    }

    fn selection(&self) -> Selection {
        let text = self.cell(Column::Motors);
        if let Some(group) = text.strip_prefix("group ") {
            return Selection::Group(group.to_owned());
        }
        let id = text.parse::<u8>().ok().and_then(|id| MotorId::new(id).ok());
        id.map_or(Selection::All, Selection::Motor)
    }

    fn step(&self, place: &str) -> Result<Step, SequenceError> {
        let quantity = self.cell(Column::Quantity);
        let action = if quantity == "brake" {
            Action::Brake
        } else {
            let mut all = Quantity::ALL.into_iter();
            let known = all.find(|known| known.field() == quantity);
            let quantity = known.unwrap_or(Quantity::Rpm);
            Action::Follow {
                quantity,
                shape: self.shape(place, quantity.field())?,
                acceleration: self.acceleration(place)?,
            }
        };
        let end = match self.condition(place)? {
            None => End::After(self.number(Column::Seconds, place, "for_s")?),
            Some(condition) => End::Until {
                condition,
                within_s: self.number(Column::Seconds, place, "within_s")?,
            },
        };
        Ok(Step::Move(Move {
            selection: self.selection(),
            action,
            end,
        }))
    }

    fn shape(&self, place: &str, field: &str) -> Result<Shape, SequenceError> {
        let value = self.number(Column::Value, place, field)?;
        let wave = || {
            Ok(Wave {
                centre: value,
                amplitude: self.number(Column::Amplitude, place, "amplitude")?,
                hz: self.number(Column::Hz, place, "hz")?,
            })
        };
        Ok(match self.cell(Column::Shape) {
            "ramp" => Shape::Ramp { to: value },
            "sine" => Shape::Sine(wave()?),
            "triangle" => Shape::Triangle(wave()?),
            "chirp" => Shape::Chirp {
                wave: wave()?,
                to_hz: self.number(Column::ToHz, place, "to_hz")?,
            },
            _ => Shape::Step { to: value },
        })
    }

    fn acceleration(&self, place: &str) -> Result<Acceleration, SequenceError> {
        if !self.has(Column::Acceleration) || self.cell(Column::Acceleration).is_empty() {
            return Ok(Acceleration::DEFAULT);
        }
        let byte = self.cell(Column::Acceleration).parse::<u8>();
        byte.map(Acceleration::new).map_err(|_| SequenceError {
            place: format!("{place}.acceleration"),
            problem: Problem::Expected("a whole number from 0 to 255"),
        })
    }

    fn passes(&self, place: &str) -> Result<u32, SequenceError> {
        let passes = self.cell(Column::Passes).parse::<u32>();
        passes.map_err(|_| SequenceError {
            place: format!("{place}.repeat"),
            problem: Problem::EndlessLoop,
        })
    }
}

fn no_number(place: String) -> SequenceError {
    SequenceError {
        place,
        problem: Problem::Expected("a number"),
    }
}

/// The place of each row in the file, such as `steps[3].steps[1]`. The end of a repeat has that of its repeat.
pub(super) fn places(rows: &[Row]) -> Vec<String> {
    let mut open: Vec<(String, usize)> = vec![(String::new(), 0)];
    let mut places = Vec::with_capacity(rows.len());
    for row in rows {
        if row.kind == Kind::EndRepeat && open.len() > 1 {
            let closed = open.pop().map(|(place, _)| place);
            let place = closed.unwrap_or_default();
            places.push(place.trim_end_matches('.').to_owned());
            continue;
        }
        let Some((list, number)) = open.last_mut() else {
            break;
        };
        let place = format!("{list}steps[{number}]");
        *number += 1;
        if row.kind == Kind::Repeat {
            open.push((format!("{place}."), 0));
        }
        places.push(place);
    }
    places
}

/// The row and the column of an error.
pub(super) fn find(rows: &[Row], place: &str) -> Option<(usize, Column)> {
    let places = places(rows);
    let matches = |own: &str| {
        place
            .strip_prefix(own)
            .filter(|rest| rest.is_empty() || rest.starts_with('.'))
            .map(|rest| rest.trim_start_matches('.').to_owned())
    };
    let own = places.iter().enumerate();
    let found = own
        .filter_map(|(row, own)| Some((row, own.len(), matches(own)?)))
        // The first row with this place is the repeat, the other one its end.
        .rev()
        .max_by_key(|(_, length, _)| *length);
    let (row, _, field) = found?;
    let column = if rows.get(row)?.kind == Kind::Repeat && !field.starts_with("until") {
        Column::Passes
    } else {
        Column::of_field(&field)
    };
    Some((row, column))
}

/// The steps of the rows. A repeat without its end goes on to the last row.
pub(super) fn steps(rows: &[Row]) -> Result<Vec<Step>, SequenceError> {
    let places = places(rows);
    let mut open: Vec<(Vec<Step>, u32, Option<Condition>)> = Vec::new();
    let mut steps = Vec::new();
    let close = |steps: Vec<Step>, (before, passes, until)| {
        let mut list: Vec<Step> = before;
        list.push(Step::Repeat(Repeat {
            passes,
            until,
            steps,
        }));
        list
    };
    for (row, place) in rows.iter().zip(&places) {
        match row.kind {
            Kind::Move => steps.push(row.step(place)?),
            Kind::Repeat => {
                let (passes, until) = (row.passes(place)?, row.condition(place)?);
                open.push((std::mem::take(&mut steps), passes, until));
            }
            Kind::EndRepeat => {
                if let Some(repeat) = open.pop() {
                    steps = close(steps, repeat);
                }
            }
        }
    }
    while let Some(repeat) = open.pop() {
        steps = close(steps, repeat);
    }
    Ok(steps)
}

/// The rows of a sequence.
pub(super) fn rows(sequence: &Sequence) -> Vec<Row> {
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

/// The limits of a run as they are typed: empty is none.
pub(super) fn limits(texts: &[String; 3]) -> Result<RunLimits, SequenceError> {
    let limit = |text: &str, field: &str| {
        let text = text.trim().replace(',', ".");
        if text.is_empty() {
            return Ok(None);
        }
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        number
            .map(Some)
            .ok_or_else(|| no_number(format!("limits.{field}")))
    };
    let [rpm, amps, celsius] = texts;
    Ok(RunLimits {
        rpm: limit(rpm, "rpm")?,
        amps: limit(amps, "amps")?,
        celsius: limit(celsius, "celsius")?,
    })
}

/// The last row of the block that begins at this row: a repeat goes with its steps.
pub(super) fn block_end(rows: &[Row], first: usize) -> usize {
    if rows.get(first).is_none_or(|row| row.kind != Kind::Repeat) {
        return first;
    }
    let mut depth = 0_usize;
    for (at, row) in rows.iter().enumerate().skip(first) {
        match row.kind {
            Kind::Repeat => depth += 1,
            Kind::EndRepeat => depth = depth.saturating_sub(1),
            Kind::Move => {}
        }
        if depth == 0 {
            return at;
        }
    }
    rows.len().saturating_sub(1)
}

#[cfg(test)]
#[path = "table_tests.rs"]
mod tests;
