//! Counts the product code of `src` and of each crate: lines without tests, blanks and comments.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;

use crate::bindgen::files_below;
use crate::workspace::Workspace;

/// Prints the lines of each crate and their sum.
pub fn show(workspace: &Workspace) -> Result<()> {
    let mut counts = BTreeMap::new();
    for top in ["src", "crates"] {
        for (path, content) in files_below(&workspace.root().join(top))? {
            if !is_product(&path) {
                continue;
            }
            let name = match path.iter().next() {
                Some(name) if top == "crates" => name.to_string_lossy().into_owned(),
                _ => top.to_owned(),
            };
            let text = String::from_utf8_lossy(&content);
            *counts.entry(name).or_insert(0) += product(&text).count();
        }
    }
    for (name, lines) in &counts {
        println!("{name:18} {lines:>6}");
    }
    println!("{:18} {:>6}", "sum", counts.values().sum::<usize>());
    Ok(())
}

/// Whether it is a Rust file of the product: not a test, a benchmark or an example.
pub fn is_product(path: &Path) -> bool {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path.extension().is_some_and(|end| end == "rs")
        && !stem.ends_with("tests")
        && !path.iter().any(|folder| {
            ["tests", "benches", "examples"]
                .iter()
                .any(|of| folder == *of)
        })
}

/// The lines of a file that rustfmt has formatted, without blanks, comments and items under `#[cfg(test)]`.
pub fn product(text: &str) -> impl Iterator<Item = &str> {
    // Indentation of the item that only tests use, from its attribute to its last line.
    let mut of_tests = None;
    let mut is_head = false;
    text.lines().filter(move |line| {
        let code = line.trim_start();
        let indentation = line.len() - code.len();
        if code == "#[cfg(test)]" {
            (of_tests, is_head) = (Some(indentation), true);
        } else if of_tests == Some(indentation) && !code.starts_with('#') {
            let ends = matches!(code, "}" | "};" | "];") || is_head && code.ends_with([';', ',']);
            is_head = false;
            if ends {
                of_tests = None;
            }
        } else {
            return of_tests.is_none() && !code.is_empty() && !code.starts_with("//");
        }
        false
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_blanks_and_comments_do_not_count() {
        let text = [
            "//! Doc.",
            "use a::b;",
            "",
            "#[cfg(test)]",
            "#[path = \"b_tests.rs\"]",
            "mod tests;",
            "",
            "/// Doc.",
            "fn f() {",
            "    // Why.",
            "    g(); // counts",
            "}",
            "#[cfg(test)]",
            "mod tests {",
            "    fn f() {",
            "    }",
            "}",
        ]
        .join("\n");
        let lines: Vec<_> = product(&text).collect();
        assert_eq!(lines, ["use a::b;", "fn f() {", "    g(); // counts", "}"]);
    }

    #[test]
    fn files_of_tests_do_not_count() {
        for (path, counts) in [
            ("bus/src/safety.rs", true),
            ("bus/src/safety_tests.rs", false),
            ("bus/tests/stopping.rs", false),
            ("bus/examples/stops.rs", false),
            ("bus/Cargo.toml", false),
        ] {
            assert_eq!(is_product(Path::new(path)), counts, "{path}");
        }
    }
}
