//! Changes the code that decides, encodes and decodes frames, one spot at a time, and asks the tests of its
//! crate to notice.

use std::fs;

use anyhow::{Context, Result, bail};
use clap::ValueEnum;

use crate::process;
use crate::tables::Rows;
use crate::tools;
use crate::workspace::Workspace;

/// A set of files that are changed, and whose tests must notice it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Set {
    /// All of crates/protocol
    Protocol,
    /// The files of crates/bus that stop, limit and time the motors and match their replies
    Bus,
    /// The files of crates/recorder that decode a saved session
    Recorder,
}

impl Set {
    const ALL: [Self; 3] = [Self::Protocol, Self::Bus, Self::Recorder];

    const fn name(self) -> &'static str {
        match self {
            Self::Protocol => "protocol",
            Self::Bus => "bus",
            Self::Recorder => "recorder",
        }
    }

    /// The changed files, below the `src` of the crate. None stands for all of them.
    const fn files(self) -> &'static [&'static str] {
        match self {
            Self::Protocol => &[],
            Self::Bus => &[
                "stop.rs",
                "safety.rs",
                "watchdog.rs",
                "limits.rs",
                "schedule.rs",
                "receiver.rs",
                "late_replies.rs",
                "late_window.rs",
            ],
            Self::Recorder => &["saved/block.rs", "saved/content.rs", "saved/rebuild.rs"],
        }
    }

    fn paths(self) -> Vec<String> {
        let files = self.files().iter();
        files
            .map(|file| format!("crates/{}/src/{file}", self.name()))
            .collect()
    }

    /// The list of changes that may survive, each with its reason.
    fn allowed(self) -> String {
        format!("crates/{}/survivors.txt", self.name())
    }

    /// The changed files, in the words of the table in docs/reliability.md.
    fn in_words(self) -> String {
        if self.files().is_empty() {
            return format!("crates/{}", self.name());
        }
        let names = self.files().iter().map(|file| file.trim_end_matches(".rs"));
        let names: Vec<_> = names.collect();
        format!("crates/{} ({})", self.name(), names.join(", "))
    }
}

/// cargo-mutants ends with these where a change survived, and where a test never ended by one.
const SURVIVED_CODE: i32 = 2;
const ENDLESS_CODE: i32 = 3;

/// A change whose tests take so many times as long as without it counts as noticed: many changes make a loop endless. Two
/// programs at once take up to three times as long as one.
const TIMEOUT_MULTIPLIER: &str = "6";

/// Bytes of address space for each program. The compiler had 0.8 GB.
const ADDRESS_SPACE_MAX: u64 = 6_000_000_000;

/// Tries every change of one set or of all, and fails where one survives without a reason, or has one
/// without surviving.
pub fn show(workspace: &Workspace, set: Option<Set>, jobs: u8) -> Result<()> {
    let chosen = set.map_or_else(|| Set::ALL.to_vec(), |set| vec![set]);
    let mut rows = Rows::default();
    let mut verdicts = Vec::new();
    for set in chosen {
        let (row, verdict) = run(workspace, set, jobs)?;
        println!("{row}");
        rows.add_line(&row);
        verdicts.push(verdict);
    }
    rows.write_into(&workspace.root().join("docs/reliability.md"), "reliability")?;
    verdicts.into_iter().collect()
}

/// Tries the changes of a set. Returns its row and whether it holds.
fn run(workspace: &Workspace, set: Set, jobs: u8) -> Result<(String, Result<()>)> {
    let root = workspace.root();
    let allowed = root.join(set.allowed());
    let allowed = fs::read_to_string(&allowed).with_context(|| format!("{}", allowed.display()))?;
    let allowed = with_reasons(&allowed, &set.allowed())?;
    let found = workspace.target().join("mutants").join(set.name());
    fs::create_dir_all(&found).with_context(|| format!("{}", found.display()))?;

    // A change that fills a list for ever would take the memory of the whole machine.
    let mut cargo = process::within_address_space(&process::cargo(), ADDRESS_SPACE_MAX);
    cargo.current_dir(root);
    cargo.env("PATH", tools::path_with_cargo_mutants()?);
    // Hundreds of links go faster without what nobody will read.
    cargo.env("CARGO_PROFILE_DEV_DEBUG", "none");
    cargo.args(["mutants", "--no-config", "--package"]);
    cargo.arg(format!("motorlink-{}", set.name()));
    for path in set.paths() {
        cargo.args(["--file", &path]);
    }
    cargo.args(["--timeout-multiplier", TIMEOUT_MULTIPLIER]);
    cargo.args(["--jobs", &jobs.to_string()]);
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
    let survivors = lines("missed.txt")?;
    let endless = lines("timeout.txt")?.len();
    let noticed = lines("caught.txt")?.len() + endless;
    let verdict = judge(&survivors, &allowed, &set.allowed());
    let reached = if verdict.is_ok() { "yes" } else { "NO" };
    let row = format!(
        "| changes of {} that no test of the crate notices | none without a reason | {} of {}, {} with a reason; {endless} never ended | {reached} |",
        set.in_words(),
        survivors.len(),
        survivors.len() + noticed,
        survivors.len() - left_over(&survivors, &allowed).len(),
    );
    Ok((row, verdict))
}

/// No survivor without a reason, and no reason without a survivor.
fn judge(survivors: &[String], allowed: &[String], file: &str) -> Result<()> {
    let list = |names: Vec<&str>| {
        let names = names.into_iter().map(|name| format!("\n  {name}"));
        names.collect::<String>()
    };
    let new = left_over(survivors, allowed);
    if !new.is_empty() {
        bail!(
            "no test notices these; write one, or a reason into {file}:{}",
            list(new)
        );
    }
    let gone = left_over(allowed, survivors);
    if !gone.is_empty() {
        bail!(
            "tests notice these now; take them out of {file}:{}",
            list(gone)
        );
    }
    Ok(())
}

/// The names without the others, one for one: several changes of a function can have the same name.
fn left_over<'a>(names: &'a [String], others: &[String]) -> Vec<&'a str> {
    let mut left: Vec<&str> = names.iter().map(String::as_str).collect();
    for other in others {
        if let Some(place) = left.iter().position(|name| name == other) {
            left.remove(place);
        }
    }
    left
}

/// Each is a line that names the change, behind a comment that says why it may survive. Changes with the same name have a
/// line each.
fn with_reasons(text: &str, file: &str) -> Result<Vec<String>> {
    let mut names = Vec::new();
    let mut has_reason = false;
    for line in text.lines().map(str::trim) {
        if line.is_empty() {
            has_reason = false;
        } else if line.starts_with('#') {
            has_reason = true;
        } else if has_reason {
            names.push(line.to_owned());
        } else {
            bail!("{file}: no reason before: {line}");
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
    use std::path::Path;

    use super::*;

    fn list(names: &[&str]) -> Vec<String> {
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
        let read = |text| with_reasons(text, "survivors.txt");
        assert_eq!(
            read("# It cannot be told.\na.rs: b\n\n# Nor this.\nc.rs: d\ne.rs: f\n").unwrap(),
            list(&["a.rs: b", "c.rs: d", "e.rs: f"])
        );
        assert!(read("a.rs: b\n").is_err());
        assert!(read("# One.\na.rs: b\n\nc.rs: d\n").is_err());
    }

    #[test]
    fn a_survivor_needs_a_reason_and_a_reason_a_survivor() {
        let judge = |survivors, allowed| judge(&list(survivors), &list(allowed), "survivors.txt");
        assert!(judge(&["a"], &["a"]).is_ok());
        assert!(judge(&["a"], &[]).is_err());
        assert!(judge(&[], &["a"]).is_err());
        assert!(judge(&["a", "a"], &["a"]).is_err());
        assert!(judge(&["a", "a"], &["a", "a"]).is_ok());
    }

    #[test]
    fn the_lists_have_reasons_and_only_files_that_are_changed() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        for set in Set::ALL {
            let text = fs::read_to_string(root.join(set.allowed())).unwrap();
            let mut paths = set.paths();
            for path in &paths {
                assert!(root.join(path).is_file(), "{path}");
            }
            if paths.is_empty() {
                paths.push(format!("crates/{}/src/", set.name()));
            }
            for name in with_reasons(&text, &set.allowed()).unwrap() {
                assert!(paths.iter().any(|path| name.starts_with(path)), "{name}");
            }
        }
    }

    #[test]
    fn a_row_names_the_crate_and_the_files() {
        assert_eq!(Set::Protocol.in_words(), "crates/protocol");
        assert_eq!(
            Set::Recorder.in_words(),
            "crates/recorder (saved/block, saved/content, saved/rebuild)"
        );
    }
}
