//! Changes the files that keep fingers whole, one spot at a time, and asks the bus's own tests to notice.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::process;
use crate::tables::Rows;
use crate::tools;
use crate::workspace::Workspace;

/// What is changed.
const FILES: [&str; 4] = [
    "crates/bus/src/stop.rs",
    "crates/bus/src/safety.rs",
    "crates/bus/src/watchdog.rs",
    "crates/bus/src/limits.rs",
];

/// Changes that may survive, each with its reason.
const ALLOWED: &str = "crates/bus/survivors.txt";

/// cargo-mutants ends with these where a change survived, and where a test never ended by one.
const SURVIVED_CODE: i32 = 2;
const ENDLESS_CODE: i32 = 3;

/// A test that takes longer than this, in seconds, has noticed; alone they take a few.
const TIMEOUT_S: &str = "120";

/// Tries every change, and fails where one survives without a reason, or has one without surviving.
pub fn show(workspace: &Workspace, jobs: u8) -> Result<()> {
    let root = workspace.root();
    let allowed = root.join(ALLOWED);
    let allowed = fs::read_to_string(&allowed).with_context(|| format!("{}", allowed.display()))?;
    let allowed = with_reasons(&allowed)?;
    let found = workspace.target().join("mutants");
    fs::create_dir_all(&found).with_context(|| format!("{}", found.display()))?;

    let mut cargo = process::cargo();
    cargo.current_dir(root);
    cargo.env("PATH", tools::path_with_cargo_mutants()?);
    // Three hundred links go faster without what nobody will read.
    cargo.env("CARGO_PROFILE_DEV_DEBUG", "none");
    cargo.args(["mutants", "--package", "motorlink-bus", "--no-config"]);
    cargo.args(FILES.iter().flat_map(|file| ["--file", file]));
    cargo.args(["--timeout", TIMEOUT_S, "--jobs", &jobs.to_string()]);
    cargo.arg("--output").arg(&found);
    cargo.args(["--", "--lib", "--tests"]);
    let status = cargo.status().context("cannot start cargo mutants")?;
    if !status.success() && !matches!(status.code(), Some(SURVIVED_CODE | ENDLESS_CODE)) {
        bail!("cargo mutants ended with {status}");
    }

    let lines = |name: &str| -> Result<Vec<String>> {
        let file = found.join("mutants.out").join(name);
        let text = fs::read_to_string(&file).with_context(|| format!("{}", file.display()))?;
        Ok(text.lines().map(without_place).collect())
    };
    let survivors: BTreeSet<String> = lines("missed.txt")?.into_iter().collect();
    let noticed = lines("caught.txt")?.len() + lines("timeout.txt")?.len();
    let verdict = judge(&survivors, &allowed);
    let reached = if verdict.is_ok() { "yes" } else { "NO" };
    let row = format!(
        "| changes of stop, safety, watchdog and limits that no test of the bus notices | none without a reason | {} of {}, {} with a reason | {reached} |",
        survivors.len(),
        survivors.len() + noticed,
        survivors.intersection(&allowed).count(),
    );
    println!("{row}");
    let mut rows = Rows::default();
    rows.add_line(&row);
    rows.write_into(&root.join("docs/reliability.md"), "reliability")?;
    verdict
}

/// No survivor without a reason, and no reason without a survivor.
fn judge(survivors: &BTreeSet<String>, allowed: &BTreeSet<String>) -> Result<()> {
    let list = |names: Vec<&String>| {
        let names = names.into_iter().map(|name| format!("\n  {name}"));
        names.collect::<String>()
    };
    let new: Vec<_> = survivors.difference(allowed).collect();
    let gone: Vec<_> = allowed.difference(survivors).collect();
    if !new.is_empty() {
        bail!(
            "no test notices these; write one, or a reason into {ALLOWED}:{}",
            list(new)
        );
    }
    if !gone.is_empty() {
        bail!(
            "tests notice these now; take them out of {ALLOWED}:{}",
            list(gone)
        );
    }
    Ok(())
}

/// Each is a line that names the change, behind a comment that says why it may survive.
fn with_reasons(text: &str) -> Result<BTreeSet<String>> {
    let mut names = BTreeSet::new();
    let mut has_reason = false;
    for line in text.lines().map(str::trim) {
        if line.is_empty() {
            has_reason = false;
        } else if line.starts_with('#') {
            has_reason = true;
        } else if has_reason {
            names.insert(line.to_owned());
        } else {
            bail!("{}: no reason before: {line}", Path::new(ALLOWED).display());
        }
    }
    Ok(names)
}

/// `crates/bus/src/stop.rs:86:9: replace ..` without line and column, which move with every edit.
fn without_place(line: &str) -> String {
    let mut parts = line.splitn(4, ':');
    match (parts.next(), parts.next(), parts.next(), parts.next()) {
        (Some(file), Some(_), Some(_), Some(what)) => format!("{file}:{what}"),
        _ => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(names: &[&str]) -> BTreeSet<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn a_survivor_is_named_without_its_line() {
        let line = "crates/bus/src/stop.rs:86:9: replace Stopping::may_brake -> bool with true";
        assert_eq!(
            without_place(line),
            "crates/bus/src/stop.rs: replace Stopping::may_brake -> bool with true"
        );
    }

    #[test]
    fn a_list_without_a_reason_is_refused() {
        assert_eq!(
            with_reasons("# It cannot be told.\na.rs: b\n\n# Nor this.\nc.rs: d\ne.rs: f\n")
                .unwrap(),
            set(&["a.rs: b", "c.rs: d", "e.rs: f"])
        );
        assert!(with_reasons("a.rs: b\n").is_err());
        assert!(with_reasons("# One.\na.rs: b\n\nc.rs: d\n").is_err());
    }

    #[test]
    fn a_survivor_needs_a_reason_and_a_reason_a_survivor() {
        assert!(judge(&set(&["a"]), &set(&["a"])).is_ok());
        assert!(judge(&set(&["a"]), &set(&[])).is_err());
        assert!(judge(&set(&[]), &set(&["a"])).is_err());
    }

    #[test]
    fn the_list_has_reasons_and_only_files_that_are_changed() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let text = fs::read_to_string(root.join(ALLOWED)).unwrap();
        for name in with_reasons(&text).unwrap() {
            assert!(FILES.iter().any(|file| name.starts_with(file)), "{name}");
        }
        for file in FILES {
            assert!(root.join(file).is_file(), "{file}");
        }
    }
}
