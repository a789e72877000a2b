//! Runs the scenarios of `tests/end-to-end` in a real browser over real Web Serial.

use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::PathBuf;
use std::process::Command;
use std::thread;

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::again::{self, AGAIN_MAX, failed_test};
use crate::bench::{self, Speed};
use crate::browser::{self, Browser};
use crate::cargo;
use crate::npm;
use crate::process;
use crate::workspace::Workspace;

/// Their program.
pub const PROGRAM: &str = "scenarios";

/// The module of scenarios that run at the same time, and that of those that a busy computer would fail.
const SIDE_BY_SIDE: &str = "side_by_side::";
const ALONE: &str = "alone::";

/// More retries in one run mean that the machine or the page is too slow.
const RETRIES_MAX: usize = 20;

/// Runs the scenarios that can run beside others, and fails if there are too many retries.
pub fn run_side_by_side(workspace: &Workspace) -> Result<()> {
    run(workspace, &[SIDE_BY_SIDE], at_once()?)
}

/// Runs the scenarios that a busy computer would fail, one by one, and fails if there are too many retries.
pub fn run_alone(workspace: &Workspace) -> Result<()> {
    run(workspace, &[ALONE], 1)
}

fn run(workspace: &Workspace, selected: &[&str], at_once: usize) -> Result<()> {
    bench::ensure_linux()?;
    let browser = browser::ensure()?;
    let axe = npm::AXE.ensure()?;
    let program = noted_program(workspace)?;
    let retries = Retries::none_yet(workspace)?;
    let run = |selected: &[&str], at_once: usize| {
        let mut program = Command::new(&program);
        program.current_dir(workspace.root().join("tests/end-to-end"));
        bench::set_paths(&mut program, workspace, &browser, Speed::QuickToBuild);
        program.env("MOTORLINK_AXE", &axe);
        program.env("MOTORLINK_RETRIES", &retries.file);
        program.args(selected);
        program.arg(format!("--test-threads={at_once}"));
        let mut failed = Vec::new();
        let result = process::run_with_lines(&mut program, |line| {
            failed.extend(failed_test(line).map(str::to_owned));
        });
        (result, failed)
    };
    let (mut passed, failed) = run(selected, at_once);
    let may_be_late = selected == [SIDE_BY_SIDE] && (1..=AGAIN_MAX).contains(&failed.len());
    if may_be_late {
        retries.note(&failed)?;
        let mut selected = vec!["--exact"];
        selected.extend(failed.iter().map(String::as_str));
        (passed, _) = run(&selected, 1);
    }
    // After a failure too: the retries may explain it.
    let within = retries.summarise();
    passed.and(within)
}

/// Notes which file is the program of the scenarios. The steps that run them need no cargo then, which waits where it builds
/// something else.
pub fn note_program(workspace: &Workspace) -> Result<()> {
    let args = ["--no-run", "--test", PROGRAM, "--message-format=json"];
    let messages = process::output(&mut cargo::native(workspace, "test", &args))?;
    let program = messages.lines().find_map(program_in);
    let program = program.context("cargo has built no program of the scenarios")?;
    let file = note(workspace);
    fs::write(&file, program).with_context(|| format!("writing {}", file.display()))
}

fn noted_program(workspace: &Workspace) -> Result<String> {
    let file = note(workspace);
    fs::read_to_string(&file).with_context(|| format!("reading {}", file.display()))
}

fn note(workspace: &Workspace) -> PathBuf {
    workspace.target().join("scenarios-program")
}

/// The path of the program in a message of cargo.
fn program_in(message: &str) -> Option<String> {
    let message: Value = serde_json::from_str(message).ok()?;
    let is_program = message.pointer("/target/name")? == PROGRAM;
    let program = message.pointer("/executable")?.as_str();
    Some(program.filter(|_| is_program)?.to_owned())
}

/// The cargo command of all scenarios; arguments that select some of them follow `--`.
pub fn command(workspace: &Workspace, browser: &Browser, speed: Speed) -> Command {
    let mut command = cargo::native(workspace, "test", &["--test", PROGRAM]);
    bench::set_paths(&mut command, workspace, browser, speed);
    command
}

/// One for each core: a scenario waits for its motor and its browser half of the time. On more than four cores nobody has
/// measured it.
fn at_once() -> Result<usize> {
    let cores = thread::available_parallelism().context("counting cores")?;
    Ok(cores.get().min(4))
}

/// The retries of a run: a line of the file each.
struct Retries {
    file: PathBuf,
}

impl Retries {
    fn none_yet(workspace: &Workspace) -> Result<Self> {
        let file = workspace.target().join("retries.txt");
        match fs::remove_file(&file) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(error).with_context(|| format!("removing {}", file.display()))
            }
            _ => Ok(Self { file }),
        }
    }

    /// Adds scenarios that run once more.
    fn note(&self, failed: &[String]) -> Result<()> {
        let mut file = OpenOptions::new()
            .append(true)
            .create(true)
            .open(&self.file)
            .with_context(|| format!("opening {}", self.file.display()))?;
        for name in failed {
            writeln!(file, "{}", again::in_words(name))?;
        }
        Ok(())
    }

    /// Prints them, and fails if there are too many.
    fn summarise(&self) -> Result<()> {
        // No retry, no file.
        let text = fs::read_to_string(&self.file).unwrap_or_default();
        for line in text.lines() {
            println!("again: {line}");
        }
        let count = text.lines().count();
        println!("retries: {count} (at most {RETRIES_MAX})");
        if count > RETRIES_MAX {
            bail!("{count} retries, more than {RETRIES_MAX}");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn retries(name: &str, count: usize) -> Retries {
        let file = std::env::temp_dir().join(format!("xtask-{name}-{}", std::process::id()));
        fs::write(&file, "a_scenario: press +100: lost\n".repeat(count)).unwrap();
        Retries { file }
    }

    #[test]
    fn too_many_retries_fail() {
        for (count, is_good) in [(0, true), (RETRIES_MAX, true), (RETRIES_MAX + 1, false)] {
            let retries = retries("retries", count);
            assert_eq!(retries.summarise().is_ok(), is_good, "{count}");
            fs::remove_file(&retries.file).unwrap();
        }
    }

    #[test]
    fn the_program_of_the_scenarios_is_named() {
        let message = |name, program: Value| {
            let target = serde_json::json!({ "name": name });
            serde_json::json!({ "target": target, "executable": program }).to_string()
        };
        let named = |text: String| program_in(&text);
        let path = Some("/target/scenarios-1".to_owned());
        assert_eq!(
            named(message("scenarios", "/target/scenarios-1".into())),
            path
        );
        assert_eq!(named(message("command", "/target/command-1".into())), None);
        assert_eq!(named(message("scenarios", Value::Null)), None);
        assert_eq!(named("{\"reason\":\"build-finished\"}".to_owned()), None);
    }

    #[test]
    fn a_scenario_that_runs_once_more_is_counted() {
        let retries = retries("again", RETRIES_MAX);
        retries.note(&["a::b".to_owned()]).unwrap();
        assert!(retries.summarise().is_err());
        fs::remove_file(&retries.file).unwrap();
    }

    #[test]
    fn every_scenario_is_in_one_of_the_two_modules() {
        let root = Workspace::find().unwrap().root().to_path_buf();
        let dir = root.join("tests/end-to-end/tests/scenarios");
        let mut names: Vec<String> = fs::read_dir(dir)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        assert_eq!(names, ["alone", "fixture", "main.rs", "side_by_side"]);
    }
}
