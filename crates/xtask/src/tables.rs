//! Tables of results in documents. Each row is a line that a program printed.

use std::{fs, path::Path};

use anyhow::{Context, Result};

/// The line after a table. The line before it names the command that makes it.
const END: &str = "<!-- end of what was measured -->";

fn begin(command: &str) -> String {
    format!("<!-- measured: made by `cargo xtask {command}`, not by hand -->")
}

/// The end of a row whose figure is not reached, as programs print it.
const NOT_REACHED: &str = "| NO |";

/// The same in a document, before the reason. A person writes it.
const REASON: &str = "| NO: ";

const HEAD: &str = "| figure | must | measured | reached |\n|---|---|---|---|\n";

/// Rows of measured figures.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Rows {
    rows: Vec<Row>,
    /// A name printed by criterion that was too long for one line.
    pending_name: String,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Row {
    figure: String,
    /// The whole line.
    line: String,
}

impl Rows {
    /// Adds the row in a line that a program printed. Most lines are no rows.
    pub fn add_line(&mut self, line: &str) {
        if let Some(row) = Row::from_table(line).or_else(|| self.read_criterion(line)) {
            self.put(row);
        }
    }

    /// Reads `decode a reply   time:   [12.1 ns 12.3 ns 12.6 ns]`, where the middle is the estimate. A long
    /// name is alone on the line before.
    fn read_criterion(&mut self, line: &str) -> Option<Row> {
        let Some((name, times)) = line.split_once("time:") else {
            line.trim().clone_into(&mut self.pending_name);
            return None;
        };
        let name = name.trim();
        let name = if name.is_empty() {
            &self.pending_name
        } else {
            name
        };
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

    /// Replaces the row of the same figure, or adds the row at the end. A figure that is still not reached keeps the reason
    /// that stands beside it.
    fn put(&mut self, mut row: Row) {
        match self
            .rows
            .iter_mut()
            .find(|other| other.figure == row.figure)
        {
            Some(other) => {
                if let (Some(bare), Some((_, reason))) = (
                    row.line.strip_suffix(NOT_REACHED),
                    other.line.split_once(REASON),
                ) {
                    row.line = format!("{bare}{REASON}{reason}");
                }
                *other = row;
            }
            None => self.rows.push(row),
        }
    }

    /// Writes these rows into a command's table in a file. Its other rows stay.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or written, or has no place for the table.
    pub fn write_into(self, file: &Path, command: &str) -> Result<()> {
        let text = fs::read_to_string(file).with_context(|| format!("{}", file.display()))?;
        let text = self.insert_into(&text, command)?;
        fs::write(file, text).with_context(|| format!("{}", file.display()))
    }

    fn insert_into(self, text: &str, command: &str) -> Result<String> {
        let begin = begin(command);
        let place = || {
            let (before, rest) = text.split_once(&begin)?;
            let (table, after) = rest.split_once(END)?;
            Some((before, table, after))
        };
        let (before, table, after) =
            place().with_context(|| format!("no place for the table: `{begin}` .. `{END}`"))?;
        let mut all = Self::default();
        for row in table.lines().filter_map(Row::from_table).chain(self.rows) {
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
    /// A measured row of four cells; not the head of the table, nor the line below it.
    fn from_table(line: &str) -> Option<Self> {
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

    fn rows_of(lines: &[&str]) -> Rows {
        let mut rows = Rows::default();
        for line in lines {
            rows.add_line(line);
        }
        rows
    }

    #[test]
    fn a_row_replaces_that_of_its_figure_and_all_else_stays() {
        let begin = begin("bench");
        let text =
            format!("# A\n{begin}\n\n{HEAD}| a | 1 | 2 | yes |\n| b | | 3 ns | |\n\n{END}\nend\n");
        let rows = rows_of(&[
            "time stolen by the host meanwhile: 0.0 %",
            "| figure | must | measured | reached |",
            "|---|---|---|---|",
            "| a | 1 | 4 | NO |",
            "| load | | could not be measured: no answer | NO |",
            "| c | 5 | 6 | yes |",
        ]);
        let written = rows.insert_into(&text, "bench").unwrap();
        let expected = format!(
            "# A\n{begin}\n\n{HEAD}| a | 1 | 4 | NO |\n| b | | 3 ns | |\n| c | 5 | 6 | yes |\n\n{END}\nend\n"
        );
        assert_eq!(written, expected);
        assert_eq!(
            Rows::default().insert_into(&written, "bench").unwrap(),
            expected
        );
    }

    #[test]
    fn a_figure_that_is_not_reached_keeps_its_reason_until_it_is_reached() {
        let text = format!(
            "{}\n\n{HEAD}| a | 1 | 2 | NO: it is slow. |\n\n{END}",
            begin("bench")
        );
        let again = rows_of(&["| a | 1 | 3 | NO |"]).insert_into(&text, "bench");
        assert!(again.unwrap().contains("| a | 1 | 3 | NO: it is slow. |"));
        let reached = rows_of(&["| a | 1 | 1 | yes |"]).insert_into(&text, "bench");
        assert!(reached.unwrap().contains("| a | 1 | 1 | yes |"));
    }

    #[test]
    fn every_figure_in_the_documents_that_is_not_reached_has_its_reason_beside_it() {
        let docs = crate::workspace::Workspace::find()
            .unwrap()
            .root()
            .join("docs");
        for document in ["performance.md", "reliability.md"] {
            let text = fs::read_to_string(docs.join(document)).unwrap();
            assert!(text.contains(HEAD), "{document}");
            let bare = text.lines().find(|line| line.ends_with(NOT_REACHED));
            assert_eq!(bare, None, "{document}");
        }
    }

    #[test]
    fn the_middle_of_what_criterion_prints_is_taken() {
        let rows = rows_of(&[
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
        assert!(Rows::default().insert_into("# A\n", "bench").is_err());
    }
}
