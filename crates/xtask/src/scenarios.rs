//! Runs the scenarios of `tests/end-to-end` in a real browser over real Web Serial.

use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;
use std::thread;

use anyhow::{Context, Result, bail};

use crate::bench::{self, Speed};
use crate::browser::{self, Browser};
use crate::cargo;
use crate::npm;
use crate::process;
use crate::workspace::Workspace;

/// The module of scenarios that run at the same time, and that of scenarios that check times.
pub const SIDE_BY_SIDE: &str = "side_by_side::";
pub const ALONE: &str = "alone::";

/// More retries in one run mean that the machine or the page is too slow.
const RETRIES_MAX: usize = 20;

/// Runs every scenario, and fails if there are too many retries.
pub fn run(workspace: &Workspace) -> Result<()> {
    bench::ensure_linux()?;
    let browser = browser::ensure()?;
    let axe = npm::AXE.ensure()?;
    let retries = Retries::none_yet(workspace)?;
    let run = |module: &str, at_once: usize| {
        let mut cargo = command(workspace, &browser, Speed::QuickToBuild);
        cargo.env("MOTORLINK_AXE", &axe);
        cargo.env("MOTORLINK_RETRIES", &retries.file);
        cargo.arg("--").arg(module);
        process::run(cargo.arg(format!("--test-threads={at_once}")))
    };
    let passed = run(SIDE_BY_SIDE, at_once()?).and_then(|()| run(ALONE, 1));
    // After a failure too: the retries may explain it.
    let within = retries.summarise();
    passed.and(within)
}

/// The cargo command of all scenarios; arguments that select some of them follow `--`.
pub fn command(workspace: &Workspace, browser: &Browser, speed: Speed) -> Command {
    let mut command = cargo::native(workspace, "test", &["--test", "scenarios"]);
    bench::set_paths(&mut command, workspace, browser, speed);
    command
}

/// A scenario mostly waits: on average it uses less than half a core.
fn at_once() -> Result<usize> {
    let cores = thread::available_parallelism().context("counting cores")?;
    Ok(cores.get() * 2)
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
