//! Tables in documents: what a program of ours printed, and nothing else.

use std::{fs, path::Path};

use anyhow::{Context, Result};

/// A table stands between a line that says which command made it and this one.
const END: &str = "<!-- end of what was measured -->";

fn begin(command: &str) -> String {
    format!("<!-- measured: made by `cargo xtask {command}`, not by hand -->")
}

const HEAD: &str = "| figure | must | measured | reached |\n|---|---|---|---|\n";

/// Rows of figures that were measured.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Rows {
    rows: Vec<Row>,
    /// A name of criterion's that was too long for one line.
    named: String,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Row {
    figure: String,
    /// The whole line.
    line: String,
}

impl Rows {
    /// Takes in a line that a program of the bench printed; most are no rows.
    pub fn hear(&mut self, line: &str) {
        if let Some(row) = Row::of_table(line).or_else(|| self.of_criterion(line)) {
            self.put(row);
        }
    }

    /// `decode a reply   time:   [12.1 ns 12.3 ns 12.6 ns]`, of which the middle is the estimate; a long
    /// name has the line before for itself.
    fn of_criterion(&mut self, line: &str) -> Option<Row> {
        let Some((name, times)) = line.split_once("time:") else {
            line.trim().clone_into(&mut self.named);
            return None;
        };
        let name = name.trim();
        let name = if name.is_empty() { &self.named } else { name };
        let times = times.trim().strip_prefix('[')?.strip_suffix(']')?;
        let words: Vec<&str> = times.split_whitespace().collect();
        let [_, _, middle, unit, _, _] = *words.as_slice() else {
            return None;
        };
        Some(Row {
            figure: name.to_owned(),
            line: format!("| {name} | | {middle} {unit} | |"),
        })
    }

    /// In the place of the row of the same figure, or as the last.
    fn put(&mut self, row: Row) {
        match self
            .rows
            .iter_mut()
            .find(|other| other.figure == row.figure)
        {
            Some(other) => *other = row,
            None => self.rows.push(row),
        }
    }

    /// Puts these rows into the table that this command makes in a file. Its other rows stay.
    ///
    /// # Errors
    ///
    /// Where the file cannot be read or written, or has no place for the table.
    pub fn write_into(self, file: &Path, command: &str) -> Result<()> {
        let text = fs::read_to_string(file).with_context(|| format!("{}", file.display()))?;
        let text = self.put_into(&text, command)?;
        fs::write(file, text).with_context(|| format!("{}", file.display()))
    }

    fn put_into(self, text: &str, command: &str) -> Result<String> {
        let begin = begin(command);
        let place = || {
            let (before, rest) = text.split_once(&begin)?;
            let (table, after) = rest.split_once(END)?;
            Some((before, table, after))
        };
        let (before, table, after) =
            place().with_context(|| format!("no place for the table: `{begin}` .. `{END}`"))?;
        let mut all = Self::default();
        for row in table.lines().filter_map(Row::of_table).chain(self.rows) {
            all.put(row);
        }
        let mut lines = String::new();
        for row in &all.rows {
            lines.push_str(&row.line);
            lines.push('\n');
        }
        Ok(format!("{before}{begin}\n\n{HEAD}{lines}\n{END}{after}"))
    }
}

impl Row {
    /// A row of four cells that is neither the head nor the line under it, and has been measured.
    fn of_table(line: &str) -> Option<Self> {
        let cells: Vec<&str> = line.strip_prefix('|')?.split('|').map(str::trim).collect();
        let [figure, _, measured, _, ""] = *cells.as_slice() else {
            return None;
        };
        let is_head = figure == "figure" || figure.starts_with("---");
        let is_figure = !measured.is_empty() && !measured.starts_with("could not be measured");
        (!is_head && is_figure).then(|| Self {
            figure: figure.to_owned(),
            line: line.trim().to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(lines: &[&str]) -> Rows {
        let mut rows = Rows::default();
        for line in lines {
            rows.hear(line);
        }
        rows
    }

    #[test]
    fn a_row_replaces_that_of_its_figure_and_all_else_stays() {
        let begin = begin("bench");
        let text =
            format!("# A\n{begin}\n\n{HEAD}| a | 1 | 2 | yes |\n| b | | 3 ns | |\n\n{END}\nend\n");
        let rows = heard(&[
            "time stolen by the host meanwhile: 0.0 %",
            "| figure | must | measured | reached |",
            "|---|---|---|---|",
            "| a | 1 | 4 | NO |",
            "| load | | could not be measured: no answer | NO |",
            "| c | 5 | 6 | yes |",
        ]);
        let written = rows.put_into(&text, "bench").unwrap();
        let expected = format!(
            "# A\n{begin}\n\n{HEAD}| a | 1 | 4 | NO |\n| b | | 3 ns | |\n| c | 5 | 6 | yes |\n\n{END}\nend\n"
        );
        assert_eq!(written, expected);
        assert_eq!(
            Rows::default().put_into(&written, "bench").unwrap(),
            expected
        );
    }

    #[test]
    fn the_middle_of_what_criterion_prints_is_taken() {
        let rows = heard(&[
            "decode a reply          time:   [12.10 ns 12.34 ns 12.60 ns]",
            "a name that is longer than there is room",
            "                        time:   [1.1 us 1.2 us 1.3 us]",
            "                        change: [-1% +0% +1%] (p = 0.5 > 0.05)",
        ]);
        let lines: Vec<_> = rows.rows.iter().map(|row| row.line.as_str()).collect();
        let expected = [
            "| decode a reply | | 12.34 ns | |",
            "| a name that is longer than there is room | | 1.2 us | |",
        ];
        assert_eq!(lines, expected);
    }

    #[test]
    fn a_file_without_a_place_is_refused() {
        assert!(Rows::default().put_into("# A\n", "bench").is_err());
    }
}
