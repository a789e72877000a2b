//! Checks `docs/invariants.md`: every file, name and test that its table gives exists.
//!
//! A reference is a path in backticks, and the names in backticks that follow it. Where an invariant is decided,
//! the file contains each name. What holds an invariant is a test of that name in the file, or a file of tests
//! as a whole, or a lint in `Cargo.toml`.

use std::{collections::BTreeSet, fs, path::Path};

use anyhow::{Context, Result, bail};

use crate::workspace::Workspace;

/// The document, from the top of the repository.
const DOCUMENT: &str = "docs/invariants.md";

/// The file whose names are lints rather than tests.
const LINTS: &str = "Cargo.toml";

/// The columns: the invariant, where it is decided, what holds it.
const COLUMNS: usize = 3;

/// A path and the names in it.
#[derive(Debug, PartialEq, Eq)]
struct Reference<'a> {
    path: &'a str,
    names: Vec<&'a str>,
}

/// Fails on a row that names what does not exist, and on one that nothing holds.
pub fn check(workspace: &Workspace) -> Result<()> {
    let document = workspace.root().join(DOCUMENT);
    let text = fs::read_to_string(&document).with_context(|| format!("cannot read {DOCUMENT}"))?;
    let wrong = faults(&text, &|path| content(&workspace.root().join(path)));
    if wrong.is_empty() {
        return Ok(());
    }
    bail!("{}", wrong.join("\n"))
}

/// The text of a file, or of all Rust files in a folder.
fn content(path: &Path) -> Option<String> {
    if !path.is_dir() {
        return fs::read_to_string(path).ok();
    }
    let mut all = String::new();
    for entry in fs::read_dir(path).ok()? {
        let inner = entry.ok()?.path();
        if inner.is_dir() || inner.extension().is_some_and(|end| end == "rs") {
            all.push_str(&content(&inner)?);
        }
    }
    Some(all)
}

/// Everything that is wrong with a document. `read` gives the text behind a path.
fn faults(document: &str, read: &dyn Fn(&str) -> Option<String>) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut rows = 0;
    let mut is_behind_head = false;
    for (index, line) in document.lines().enumerate() {
        let mut fail = |fault: String| wrong.push(format!("{DOCUMENT}:{}: {fault}", index + 1));
        let Some(cells) = cells(line) else {
            is_behind_head = false;
            continue;
        };
        if !is_behind_head {
            is_behind_head = cells.iter().all(|cell| is_rule(cell));
            continue;
        }
        rows += 1;
        let [_, decided, held] = cells.as_slice() else {
            fail(format!("a row has {COLUMNS} cells"));
            continue;
        };
        for (cell, is_held) in [(decided, false), (held, true)] {
            wrong_in(cell, is_held, read)
                .into_iter()
                .for_each(&mut fail);
        }
    }
    if rows == 0 {
        wrong.push(format!("{DOCUMENT}: there is no table"));
    }
    wrong
}

/// The cells of a row; nothing for a line outside of tables.
fn cells(line: &str) -> Option<Vec<&str>> {
    let inner = line.trim().strip_prefix('|')?.strip_suffix('|')?;
    Some(inner.split('|').map(str::trim).collect())
}

/// Whether a cell is part of the line below the head of a table.
fn is_rule(cell: &str) -> bool {
    cell.starts_with('-') && cell.chars().all(|c| c == '-')
}

/// What is wrong with a cell: the place where an invariant is decided, or the tests that hold it.
fn wrong_in(cell: &str, is_held: bool, read: &dyn Fn(&str) -> Option<String>) -> Vec<String> {
    let references = match references(cell) {
        Ok(references) => references,
        Err(fault) => return vec![fault],
    };
    if references.is_empty() {
        let none = if is_held {
            "no test holds this"
        } else {
            "no path says where this is decided"
        };
        return vec![none.to_owned()];
    }
    let mut wrong = Vec::new();
    for Reference { path, names } in references {
        let Some(text) = read(path) else {
            wrong.push(format!("{path} does not exist"));
            continue;
        };
        let (kind, known) = match path {
            _ if !is_held => ("name", words(&text).collect()),
            LINTS => ("lint", words(&text).collect()),
            _ => ("test", tests(&text)),
        };
        if is_held && (known.is_empty() || path == LINTS && names.is_empty()) {
            wrong.push(format!("{path} has no {kind}"));
        }
        // Of `Type::function` both parts are in the file.
        let is_known = |name: &str| name.split("::").all(|part| known.contains(part));
        let missing = names.iter().filter(|name| !is_known(name));
        wrong.extend(missing.map(|name| format!("{path} has no {kind} {name}")));
    }
    wrong
}

/// The references of a cell. Commands, which contain a space, are none.
fn references(cell: &str) -> Result<Vec<Reference<'_>>, String> {
    let mut references: Vec<Reference<'_>> = Vec::new();
    for name in cell.split('`').skip(1).step_by(2) {
        if name.contains(' ') {
            continue;
        }
        if name.contains(['/', '.']) {
            references.push(Reference {
                path: name,
                names: Vec::new(),
            });
            continue;
        }
        let last = references.last_mut();
        let last = last.ok_or_else(|| format!("{name} follows no path"))?;
        last.names.push(name);
    }
    Ok(references)
}

/// The identifiers of a text.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
        .filter(|word| !word.is_empty())
}

/// The names of the tests in a file of Rust, or in one of Python.
fn tests(text: &str) -> BTreeSet<&str> {
    let mut names = BTreeSet::new();
    let mut is_test = false;
    for line in text.lines().map(str::trim) {
        is_test |= ["#[test]", "#[wasm_bindgen_test"]
            .iter()
            .any(|attribute| line.starts_with(attribute));
        // As Python's unittest finds them.
        if let Some(name) = line.strip_prefix("def ")
            && name.starts_with("test_")
        {
            names.extend(words(name).next());
        }
        let mut before = words(line);
        if line.starts_with(['#', '/']) || !before.any(|word| word == "fn") {
            continue;
        }
        if is_test {
            names.extend(before.next());
        }
        is_test = false;
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "| invariant | decided in | held by |\n|---|---|---|\n";

    /// A repository of three files.
    fn read(path: &str) -> Option<String> {
        let text = match path {
            "a/code.rs" => "impl Bus { fn stop_all(&self) {} }",
            "a/tests.rs" => {
                "#[test]\n#[ignore]\nfn it_stops() {}\n\nfn helper() {}\n\n\
                 #[wasm_bindgen_test]\nasync fn it_waits() {}"
            }
            "Cargo.toml" => "panic = \"deny\"",
            _ => return None,
        };
        Some(text.to_owned())
    }

    fn faults_of(row: &str) -> Vec<String> {
        faults(&format!("{HEAD}{row}"), &read)
    }

    #[test]
    fn the_table_names_what_exists() {
        check(&Workspace::find().unwrap()).unwrap();
    }

    #[test]
    fn a_row_with_existing_names_is_accepted() {
        for row in [
            "| It stops. | `a/code.rs` `Bus::stop_all` | `a/tests.rs`: `it_stops`, `it_waits` |",
            "| It stops. | `a/code.rs` | `a/tests.rs`; by hand `cargo xtask soak` |",
            "| It does not panic. | `a/code.rs` | `Cargo.toml`: `panic` |",
        ] {
            assert_eq!(faults_of(row), [""; 0], "{row}");
        }
    }

    #[test]
    fn a_missing_name_is_reported_with_its_line() {
        for (row, expected) in [
            (
                "| x | `a/gone.rs` | `a/tests.rs` |",
                "a/gone.rs does not exist",
            ),
            (
                "| x | `a/code.rs` `Bus::go` | `a/tests.rs` |",
                "a/code.rs has no name Bus::go",
            ),
            (
                "| x | `a/code.rs` | `a/tests.rs`: `it_goes` |",
                "a/tests.rs has no test it_goes",
            ),
            (
                "| x | `a/code.rs` | `a/tests.rs`: `helper` |",
                "a/tests.rs has no test helper",
            ),
            ("| x | `a/code.rs` | `a/code.rs` |", "a/code.rs has no test"),
            ("| x | `a/code.rs` | `a/gone/` |", "a/gone/ does not exist"),
            (
                "| x | `a/code.rs` | `Cargo.toml`: `unwrap_used` |",
                "Cargo.toml has no lint unwrap_used",
            ),
            (
                "| x | `a/code.rs` | `Cargo.toml` |",
                "Cargo.toml has no lint",
            ),
            (
                "| x | `a/code.rs` | `it_stops` |",
                "it_stops follows no path",
            ),
            (
                "| x | `a/code.rs` | `cargo xtask soak` |",
                "no test holds this",
            ),
            (
                "| x | somewhere | `a/tests.rs` |",
                "no path says where this is decided",
            ),
            ("| x | `a/code.rs` |", "a row has 3 cells"),
        ] {
            assert_eq!(
                faults_of(row),
                [format!("{DOCUMENT}:3: {expected}")],
                "{row}"
            );
        }
    }

    #[test]
    fn a_document_without_a_row_is_refused() {
        assert_eq!(faults(HEAD, &read).len(), 1);
        assert_eq!(faults("Nothing.", &read).len(), 1);
    }

    #[test]
    fn rows_of_every_table_are_read() {
        let row = "| x | `a/gone.rs` | `a/tests.rs` |\n";
        let document = format!("{HEAD}{row}\n## More\n\n{HEAD}{row}");
        assert_eq!(faults(&document, &read).len(), 2);
    }
}
