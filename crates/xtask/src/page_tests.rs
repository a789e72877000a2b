//! Runs the tests of page and worker in a real browser.

use std::fs;
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::again::{self, AGAIN_MAX, failed_test};
use crate::browser;
use crate::cargo;
use crate::process;
use crate::suite;
use crate::tools;
use crate::workspace::Workspace;

/// Number of browsers among which the tests of the page are divided. With three on two cores, a page was not drawn for half
/// a second at a time.
const SHARES: usize = 2;

/// These tests follow the focus, to which the pages of earlier tests in the same document react too. So they have a
/// browser to themselves.
const ALONE: &str = "names";

/// Runs all of them, in several browsers at the same time.
pub fn run(workspace: &Workspace) -> Result<()> {
    let runner = tools::ensure_wasm_bindgen(workspace)?.test_runner;
    let browser = browser::ensure()?;
    // Not the examples in the documentation: those of a page cannot run alone. Each program only calls its library.
    let targets = ["--lib", "--test", "page"];
    let mut build = cargo::wasm_tests(workspace, "test", &targets)?;
    // It delays no motor in the tests beside it.
    process::run(&mut suite::patient(build.arg("--no-run")))?;

    let test = |args: &[&str]| -> Result<Command> {
        let mut command = cargo::wasm_tests(workspace, "test", args)?;
        command
            .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER", &runner)
            // In seconds, for all tests of a program together; the runner's own 20 are too few.
            .env("WASM_BINDGEN_TEST_TIMEOUT", "300")
            .env("CHROMEDRIVER", &browser.driver);
        Ok(command)
    };
    let mut commands = vec![test(&["--lib"])?];
    let without = |skipped: &[String]| -> Result<Command> {
        let mut command = test(&["--test", "page", "--"])?;
        for module in skipped {
            command.args(["--skip", &format!("{module}::")]);
        }
        Ok(command)
    };
    let (alone, shared): (Modules, Modules) = modules(workspace)?
        .into_iter()
        .partition(|(name, _)| name == ALONE);
    for share in 0..SHARES {
        let mut skipped = left_out(&shared, share);
        skipped.extend(alone.iter().map(|(name, _)| name.clone()));
        commands.push(without(&skipped)?);
    }
    let mut failed = Vec::new();
    for (printed, passed) in process::run_all(&mut commands) {
        if let Err(error) = passed {
            failed.extend(failed_tests(&printed).ok_or(error)?);
        }
    }
    if failed.len() > AGAIN_MAX {
        bail!("{} tests failed", failed.len());
    }
    // Each in a browser of its own: the page of one that failed stays in the document of the tests behind it.
    for name in &failed {
        println!("again: {}", again::in_words(name));
        let (printed, passed) =
            process::run_captured(&mut test(&["--test", "page", "--", "--exact", name])?);
        passed?;
        if !printed.contains("test result: ok. 1 passed") {
            bail!("{name} failed, and is no test of the page");
        }
    }
    println!("retries: {} (at most {AGAIN_MAX})", failed.len());
    let others: Vec<String> = shared.into_iter().map(|(name, _)| name).collect();
    process::run(&mut without(&others)?)
}

/// The names of the tests that failed in a program. `None` unless it came to its end and counts as many.
fn failed_tests(printed: &str) -> Option<Vec<String>> {
    let failed: Vec<String> = printed
        .lines()
        .filter_map(failed_test)
        .map(str::to_owned)
        .collect();
    let count = format!("; {} failed; ", failed.len());
    let counts = |line: &str| line.starts_with("test result: FAILED. ") && line.contains(&count);
    printed.lines().any(counts).then_some(failed)
}

/// Modules of the page's tests, with how many tests are in each.
type Modules = Vec<(String, usize)>;

fn modules(workspace: &Workspace) -> Result<Modules> {
    let dir = workspace.root().join("tests/page");
    let mut modules = Modules::new();
    let entries = fs::read_dir(&dir).with_context(|| format!("reading {}", dir.display()))?;
    for entry in entries {
        let path = entry?.path();
        let name = path.file_stem().context("a file without a name")?;
        let files = if path.is_dir() {
            crate::bindgen::files_below(&path)?
        } else {
            vec![(path.clone(), fs::read(&path)?)]
        };
        let count = files
            .iter()
            .map(|(_, content)| {
                String::from_utf8_lossy(content)
                    .matches("#[wasm_bindgen_test")
                    .count()
            })
            .sum();
        // Other modules have helpers only.
        if count > 0 {
            modules.push((name.to_string_lossy().into_owned(), count));
        }
    }
    Ok(modules)
}

/// The modules that are not in this share. Each module, the largest first, goes to the share with the
/// fewest tests.
fn left_out(modules: &Modules, share: usize) -> Vec<String> {
    let mut sorted = modules.clone();
    sorted.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    let mut loads = [0; SHARES];
    let mut others = Vec::new();
    for (name, count) in sorted {
        let Some((lightest, load)) = loads.iter_mut().enumerate().min_by_key(|(_, load)| **load)
        else {
            break;
        };
        *load += count;
        if lightest != share {
            others.push(name);
        }
    }
    others
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_module_is_in_one_share() {
        let modules = modules(&Workspace::find().unwrap()).unwrap();
        assert!(modules.iter().map(|(_, count)| count).sum::<usize>() > 100);
        for (name, _) in &modules {
            let others = (0..SHARES).filter(|share| left_out(&modules, *share).contains(name));
            assert_eq!(others.count(), SHARES - 1, "{name}");
            // `--skip` matches anywhere in a name.
            let ends = |other: &&(String, usize)| other.0.ends_with(name.as_str());
            assert_eq!(modules.iter().filter(ends).count(), 1, "{name}");
        }
    }

    #[test]
    fn tests_that_failed_are_named_if_their_program_has_ended() {
        let told = |text: &str| failed_tests(text);
        let failed = "test a::b ... ok\ntest a::c ... FAIL\n";
        let ended = format!("{failed}test result: FAILED. 1 passed; 1 failed; 0 ignored\n");
        assert_eq!(told(&ended), Some(vec!["a::c".to_owned()]));
        assert_eq!(told(&format!("{failed}It might have timed out.\n")), None);
        assert_eq!(told(&format!("{failed}{ended}")), None);
        assert_eq!(
            told("test a::b ... ok\ntest result: ok. 1 passed; 0 failed; 0\n"),
            None
        );
    }

    #[test]
    fn shares_are_about_as_large() {
        let modules = [("a", 6), ("b", 5), ("c", 4), ("d", 3)];
        let modules: Modules = modules.map(|(name, count)| (name.to_owned(), count)).into();
        assert_eq!(left_out(&modules, 0), ["b", "c"]);
        assert_eq!(left_out(&modules, 1), ["a", "d"]);
    }
}
