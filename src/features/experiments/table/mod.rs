//! The table of steps as it is typed: a row for each step, for each repeat and for the end of each repeat.
//!
//! | file | idea |
//! |---|---|
//! | `reading` | from rows to steps, and to the place of an error |
//! | `writing` | from steps to rows |

mod reading;
mod writing;

pub(super) use reading::{find, limits, steps};
use strum::{IntoStaticStr, VariantArray};
pub(super) use writing::rows;

/// What a row is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    #[default]
    Move,
    Repeat,
    EndRepeat,
}

/// A column of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "snake_case", const_into_str)]
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
    /// Its key in the elements of the table.
    pub(super) const fn key(self) -> &'static str {
        self.into_str()
    }

    pub(super) fn from_key(key: &str) -> Option<Self> {
        let mut all = Self::VARIANTS.iter().copied();
        all.find(|column| column.key() == key)
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
    cells: [String; Column::VARIANTS.len()],
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
mod tests;
