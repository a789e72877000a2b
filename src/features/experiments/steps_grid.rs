//! The rows of the table as HTML: only those that can be seen, since a table can have ten thousand.

use std::fmt::Write;

use motorlink_i18n::tr;
use motorlink_messages::protocol::MotorId;

use crate::{
    features::experiments::{
        state::GROUP,
        table::{Column, ENDS, Kind, QUANTITIES, Row, SHAPES},
    },
    ui::{escape::escaped, format},
};

/// The height of a row in pixels, as the style sheet has it.
pub(super) const ROW_PX: usize = 38;

/// The columns of numbers of a step in their order on the page.
const COLUMNS: [Column; 12] = [
    Column::Motors,
    Column::Quantity,
    Column::Shape,
    Column::Value,
    Column::Amplitude,
    Column::Hz,
    Column::ToHz,
    Column::Acceleration,
    Column::Until,
    Column::Bound,
    Column::Tolerance,
    Column::Seconds,
];

/// What the table shows besides its rows.
pub(super) struct Shown<'a> {
    /// The motors to choose from, and how they are named.
    pub(super) motors: &'a [(MotorId, String)],
    pub(super) selected: usize,
    pub(super) wrong: Option<(usize, Column)>,
}

/// The name of a column.
pub(super) fn name(column: Column) -> &'static str {
    match column {
        Column::Motors => tr!("Motors"),
        Column::Quantity => tr!("Quantity"),
        Column::Shape => tr!("Shape"),
        Column::Value => tr!("Setpoint"),
        Column::Amplitude => tr!("Amplitude"),
        Column::Hz => tr!("Frequency"),
        Column::ToHz => tr!("End frequency"),
        Column::Acceleration => tr!("Acceleration"),
        Column::Until => tr!("Until"),
        Column::Bound => tr!("Threshold"),
        Column::Tolerance => tr!("Tolerance"),
        Column::Seconds => tr!("Seconds"),
        Column::Passes => tr!("Passes"),
    }
}

/// The words of a choice.
fn choice(column: Column, key: &str) -> String {
    let words = match (column, key) {
        (Column::Quantity, "rpm") => format::rpm(),
        (Column::Quantity, "amps") => "A",
        (Column::Quantity, "degrees") => "°",
        (Column::Quantity, _) => tr!("Brake"),
        (Column::Shape, "ramp") => tr!("Ramp"),
        (Column::Shape, "sine") => tr!("Sine"),
        (Column::Shape, "triangle") => tr!("Triangle"),
        (Column::Shape, "chirp") => tr!("Chirp"),
        (Column::Shape, _) => tr!("Step"),
        (_, "rpm_above") => tr!("speed above"),
        (_, "rpm_below") => tr!("speed below"),
        (_, "degrees") => tr!("angle near"),
        (_, "celsius_above") => tr!("temperature above"),
        (_, "celsius_below") => tr!("temperature below"),
        _ => tr!("time"),
    };
    words.to_owned()
}

/// The head of the table.
pub(super) fn head() -> String {
    let mut html = String::from("<span role=\"columnheader\">#</span>");
    for column in COLUMNS {
        let _ = write!(html, "<span role=\"columnheader\">{}</span>", name(column));
    }
    html
}

/// The rows from `first` on.
pub(super) fn html(rows: &[Row], first: usize, count: usize, shown: &Shown<'_>) -> String {
    let mut html = String::new();
    let before = rows.get(..first).unwrap_or_default();
    let mut depth: usize = 0;
    for row in before {
        depth = next_depth(depth, row.kind);
    }
    for (at, row) in rows.iter().enumerate().skip(first).take(count) {
        if row.kind == Kind::EndRepeat {
            depth = depth.saturating_sub(1);
        }
        write_row(&mut html, row, at, depth, shown);
        if row.kind == Kind::Repeat {
            depth += 1;
        }
    }
    html
}

const fn next_depth(depth: usize, kind: Kind) -> usize {
    match kind {
        Kind::Move => depth,
        Kind::Repeat => depth + 1,
        Kind::EndRepeat => depth.saturating_sub(1),
    }
}

fn write_row(html: &mut String, row: &Row, at: usize, depth: usize, shown: &Shown<'_>) {
    let number = at + 1;
    let is_selected = shown.selected == at;
    let _ = write!(
        html,
        "<div role=\"row\" class=\"step-row{}\" aria-rowindex=\"{}\" aria-selected=\"{is_selected}\" \
         data-row=\"{at}\"><span role=\"gridcell\" class=\"step-number d{}\">{number}</span>",
        if is_selected { " selected" } else { "" },
        number + 1,
        depth.min(4),
    );
    match row.kind {
        Kind::EndRepeat => {
            let _ = write!(
                html,
                "<span role=\"gridcell\" class=\"step-wide\">{}</span>",
                tr!("End of the repeat")
            );
        }
        Kind::Repeat => {
            let _ = write!(
                html,
                "<span role=\"gridcell\" class=\"step-word\">{}</span>",
                tr!("Repeat")
            );
            write_cell(html, row, at, Column::Passes, shown);
            let _ = write!(
                html,
                "<span role=\"gridcell\" class=\"step-word step-gap\">{}</span>",
                tr!("times, or until")
            );
            for column in [Column::Until, Column::Bound, Column::Tolerance] {
                write_cell(html, row, at, column, shown);
            }
            html.push_str("<span role=\"gridcell\"></span>");
        }
        Kind::Move => {
            for column in COLUMNS {
                write_cell(html, row, at, column, shown);
            }
        }
    }
    html.push_str("</div>");
}

fn write_cell(html: &mut String, row: &Row, at: usize, column: Column, shown: &Shown<'_>) {
    if !row.has(column) {
        html.push_str("<span role=\"gridcell\"></span>");
        return;
    }
    let key = column.key();
    let label = tr!("{column} of row {row}", column = name(column), row = at + 1);
    let wrong = shown.wrong == Some((at, column));
    let state = if wrong { " aria-invalid=\"true\"" } else { "" };
    let cell = escaped(row.cell(column));
    html.push_str("<span role=\"gridcell\">");
    if column.is_choice() {
        let _ = write!(
            html,
            "<select data-cell=\"{at}:{key}\" aria-label=\"{label}\"{state}>"
        );
        for (value, words) in choices(column, row, shown) {
            let selected = if value == row.cell(column) {
                " selected"
            } else {
                ""
            };
            let (value, words) = (escaped(&value), escaped(&words));
            let _ = write!(html, "<option value=\"{value}\"{selected}>{words}</option>");
        }
        html.push_str("</select>");
    } else {
        let _ = write!(
            html,
            "<input type=\"text\" autocomplete=\"off\" spellcheck=\"false\" \
             data-cell=\"{at}:{key}\" aria-label=\"{label}\" value=\"{cell}\"{state}>"
        );
    }
    html.push_str("</span>");
}

fn choices(column: Column, row: &Row, shown: &Shown<'_>) -> Vec<(String, String)> {
    let keyed = |keys: &[&str]| {
        keys.iter()
            .map(|key| ((*key).to_owned(), choice(column, key)))
            .collect()
    };
    match column {
        Column::Quantity => keyed(&QUANTITIES),
        Column::Shape => keyed(&SHAPES),
        Column::Motors => {
            let mut all = vec![
                ("all".to_owned(), tr!("all").to_owned()),
                (format!("group {GROUP}"), tr!("group").to_owned()),
            ];
            let motors = shown.motors.iter();
            all.extend(motors.map(|(id, named)| (id.get().to_string(), named.clone())));
            // A motor or a group of a file that is not here stays visible; the check names it.
            let own = row.cell(column);
            if !all.iter().any(|(value, _)| value == own) {
                all.push((own.to_owned(), own.to_owned()));
            }
            all
        }
        _ => keyed(&ENDS),
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::experiments::sequence::Template;

    use super::*;
    use crate::features::experiments::table::rows;

    const NONE: Shown<'static> = Shown {
        motors: &[],
        selected: 0,
        wrong: None,
    };

    #[test]
    fn only_the_rows_that_can_be_seen_are_written() {
        let rows = vec![Row::new_step(); 10_000];
        let html = html(&rows, 5_000, 20, &NONE);
        assert_eq!(html.matches("role=\"row\"").count(), 20);
        assert!(html.contains("data-cell=\"5000:value\""));
        assert!(html.len() < 100_000);
    }

    #[test]
    fn the_wrong_cell_says_so_and_texts_are_escaped() {
        let mut rows = rows(&Template::BackAndForth.sequence());
        rows[1].set(Column::Motors, "group <b>");
        let shown = Shown {
            wrong: Some((1, Column::Value)),
            ..NONE
        };
        let html = html(&rows, 0, 10, &shown);
        assert_eq!(html.matches("aria-invalid").count(), 1);
        assert!(
            html.contains("&lt;b&gt;") && !html.contains("<b>"),
            "{html}"
        );
    }
}
