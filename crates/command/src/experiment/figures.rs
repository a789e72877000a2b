//! The figures of an experiment as text.

use std::fmt::Write;

use motorlink_experiments::{
    kept::{Row, figures},
    study::Findings,
};

/// More rows than these are a table with a row each; fewer have a column each, because their names are long.
const COLUMNS_MAX: usize = 6;

/// The figures as text: names with their units, and values. `-` is unknown.
#[must_use]
pub fn to_text(findings: &Findings) -> String {
    let rows = figures(findings);
    let Some(first) = rows.first() else {
        return "no figures: too little was measured".to_owned();
    };
    let names: Vec<&str> = first.iter().map(|(name, _)| *name).collect();
    let cells: Vec<Vec<String>> = rows.iter().map(texts).collect();
    let column = |place: usize| cells.iter().filter_map(move |row| row.get(place));
    let is_constant = |place: usize| {
        let mut values = column(place);
        let first = values.next();
        values.all(|value| Some(value) == first)
    };
    let mut out = String::new();
    let width = names
        .iter()
        .map(|name| name.len())
        .max()
        .unwrap_or_default();
    let (constant, varying): (Vec<usize>, Vec<usize>) =
        (0..names.len()).partition(|place| is_constant(*place));
    let name = |place: usize| names.get(place).copied().unwrap_or_default();
    for place in constant {
        let value = column(place).next().map_or("-", String::as_str);
        let _ = writeln!(out, "{:width$}  {value}", name(place));
    }
    if rows.len() <= COLUMNS_MAX {
        for place in varying {
            let _ = write!(out, "{:width$}", name(place));
            for value in column(place) {
                let _ = write!(out, "  {value:>10}");
            }
            out.push('\n');
        }
    } else {
        let width_of = |place: usize| {
            let values = column(place).map(String::len).max().unwrap_or_default();
            values.max(name(place).len())
        };
        let mut line = |cells: &mut dyn Iterator<Item = (usize, &str)>| {
            for (place, text) in cells {
                let width = width_of(place);
                let _ = write!(out, "{text:>width$}  ");
            }
            out.truncate(out.trim_end().len());
            out.push('\n');
        };
        line(&mut varying.iter().map(|place| (*place, name(*place))));
        for row in &cells {
            let text = |place: &usize| (*place, row.get(*place).map_or("", String::as_str));
            line(&mut varying.iter().map(text));
        }
    }
    out.truncate(out.trim_end().len());
    out
}

fn texts(row: &Row) -> Vec<String> {
    let text = |text: String| {
        if text.is_empty() {
            "-".to_owned()
        } else {
            text
        }
    };
    row.iter().map(|(_, cell)| text(cell.text())).collect()
}
