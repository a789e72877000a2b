//! The checks, each a step with a name, in the order in which they run: the quick ones first.

use std::process::{Command, Stdio};

use anyhow::Result;

use crate::bench;
use crate::browser;
use crate::process;
use crate::site::{self, Profile};
use crate::stories;
use crate::tools::{self, WASM_TARGET};
use crate::words;
use crate::workspace::Workspace;

/// Leaves what only runs in the browser out of a call on the whole workspace.
const NATIVE: [&str; 5] = [
    "--workspace",
    "--exclude",
    "motorlink",
    "--exclude",
    "motorlink-worker",
];

/// Lints and nothing else: in RUSTFLAGS it would rebuild every dependency.
const DENY_WARNINGS: [&str; 3] = ["--", "-D", "warnings"];

/// One check.
#[derive(Debug)]
pub struct Step {
    /// What `--only` calls it.
    pub name: &'static str,
    /// What it checks.
    pub about: &'static str,
    /// Steps whose results it uses.
    pub needs: &'static [&'static str],
    /// Does it.
    pub run: fn(&Workspace) -> Result<()>,
}

/// Every step, in order.
pub static STEPS: [Step; 12] = [
    Step {
        name: "format",
        about: "the sources are formatted",
        needs: &[],
        run: |workspace| cargo(workspace, &["fmt", "--all", "--check"]),
    },
    Step {
        name: "words",
        about: "every message of the code has its translations",
        needs: &[],
        run: |workspace| words::update(workspace, true),
    },
    Step {
        name: "dependencies",
        about: "what we depend on is locked, licensed, from the registry, and there once",
        needs: &[],
        run: dependencies,
    },
    Step {
        name: "clippy",
        about: "no warnings in what runs natively",
        needs: &[],
        run: |workspace| {
            let args = [&["clippy", "--all-targets"], &NATIVE[..], &DENY_WARNINGS];
            cargo(workspace, &args.concat())
        },
    },
    Step {
        name: "clippy-wasm",
        about: "no warnings in what runs in the browser, tests included",
        needs: &[],
        run: |workspace| {
            let targets = ["--lib", "--bins", "--tests"];
            wasm(
                workspace,
                "clippy",
                &[&targets[..], &DENY_WARNINGS].concat(),
            )
        },
    },
    Step {
        name: "doc",
        about: "the documentation builds without warnings",
        needs: &[],
        run: |workspace| {
            let native = [&["doc", "--no-deps"], &NATIVE[..]].concat();
            strict_doc(cargo_command(workspace, &native))?;
            tools::ensure_wasm_target()?;
            strict_doc(wasm_command(workspace, "doc", &["--no-deps"]))
        },
    },
    Step {
        name: "test",
        about: "tests of what runs natively",
        needs: &[],
        run: |workspace| {
            let args = [
                &["test", "--quiet"],
                &NATIVE[..],
                &["--exclude", "end-to-end"],
            ];
            cargo(workspace, &args.concat())
        },
    },
    Step {
        name: "test-page",
        about: "tests of the page's pure parts, natively",
        needs: &[],
        run: |workspace| {
            cargo(
                workspace,
                &["test", "--quiet", "--package", "motorlink", "--lib"],
            )
        },
    },
    Step {
        name: "test-wasm",
        about: "tests of page and worker in a real browser",
        needs: &[],
        run: test_wasm,
    },
    Step {
        name: "build",
        about: "the released site builds, is light enough and names no other host",
        needs: &[],
        run: |workspace| {
            // Linking the site and compiling the bench's library keep one core each busy for minutes.
            let mut stories = stories::compiling(workspace);
            let build = || site::build(workspace, Profile::Release);
            let dist = process::run_beside(&mut stories, build)?;
            bench::check_first_visit(&dist)
        },
    },
    Step {
        name: "bench-programs",
        about: "the programs of the bench build",
        needs: &[],
        run: bench::build_programs,
    },
    Step {
        name: "end-to-end",
        about: "the page in a real browser drives a motor over real Web Serial",
        needs: &["build", "bench-programs"],
        run: stories::play,
    },
];

/// The step of a name, for the command line.
///
/// # Errors
///
/// Words for a name that no step has.
pub fn by_name(name: &str) -> Result<&'static Step, String> {
    STEPS
        .iter()
        .find(|step| step.name == name)
        .ok_or_else(|| "no such step, cargo xtask test --list names them".to_owned())
}

/// Cargo with its flags, at the top of the workspace.
fn cargo_command(workspace: &Workspace, args: &[&str]) -> Command {
    let mut cargo = process::cargo();
    cargo.current_dir(workspace.root()).args(args);
    cargo
}

fn cargo(workspace: &Workspace, args: &[&str]) -> Result<()> {
    process::run(&mut cargo_command(workspace, args))
}

/// Cargo on the page and the worker.
///
/// Always on both at once: alone each would get its own selection of features, and what they share
/// would be built again.
fn wasm_command(workspace: &Workspace, verb: &str, args: &[&str]) -> Command {
    let packages = ["--package", "motorlink", "--package", "motorlink-worker"];
    let target = ["--target", WASM_TARGET];
    cargo_command(workspace, &[&[verb], &target[..], &packages, args].concat())
}

fn wasm(workspace: &Workspace, verb: &str, args: &[&str]) -> Result<()> {
    tools::ensure_wasm_target()?;
    process::run(&mut wasm_command(workspace, verb, args))
}

fn strict_doc(mut command: Command) -> Result<()> {
    process::run(command.env("RUSTDOCFLAGS", "-D warnings"))
}

/// Advisories need a database that lies outside the registries: where it cannot be had, that is said.
fn dependencies(workspace: &Workspace) -> Result<()> {
    let mut locked = cargo_command(
        workspace,
        &["metadata", "--locked", "--format-version", "1"],
    );
    process::run(locked.stdout(Stdio::null()))?;
    let deny = tools::ensure_cargo_deny()?;
    let check = |of: &[&str], what: &[&str]| {
        let mut command = Command::new(&deny);
        command
            .current_dir(workspace.root())
            .arg("--all-features")
            .args(of)
            .args(["check", "--hide-inclusion-graph", "--deny", "warnings"])
            .args(what);
        process::run(&mut command)
    };
    let all = ["--workspace"];
    check(&all, &["licenses", "sources"])?;
    // What is in the page, and what is in its workers.
    check(&[], &["bans"])?;
    // The worker has not all that is excepted for the page.
    let skips = ["--allow", "unmatched-skip", "--allow", "unnecessary-skip"];
    check(
        &["--manifest-path", "crates/worker/Cargo.toml"],
        &[&skips[..], &["bans"]].concat(),
    )?;
    let mut fetch = Command::new(&deny);
    fetch.current_dir(workspace.root()).args(["fetch", "db"]);
    if process::run(&mut fetch).is_err() {
        println!("the advisories were not looked at: their database cannot be fetched from here");
        return Ok(());
    }
    check(&all, &["advisories"])
}

fn test_wasm(workspace: &Workspace) -> Result<()> {
    tools::ensure_wasm_target()?;
    let runner = tools::ensure_wasm_bindgen(workspace)?.test_runner;
    let browser = browser::ensure()?;
    // Not the examples in the documentation: those of a page cannot run alone.
    let mut command = wasm_command(workspace, "test", &["--lib", "--bins", "--tests"]);
    command
        .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER", runner)
        // In seconds, for all tests of a program together; the runner's own 20 are too few.
        .env("WASM_BINDGEN_TEST_TIMEOUT", "300")
        .env("CHROMEDRIVER", browser.driver);
    process::run(&mut command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_needs_come_earlier() {
        for (place, step) in STEPS.iter().enumerate() {
            assert!(std::ptr::eq(by_name(step.name).unwrap(), step));
            for need in step.needs {
                let before = STEPS[..place].iter().any(|earlier| earlier.name == *need);
                assert!(before, "{} needs {need}", step.name);
            }
        }
    }

    #[test]
    fn an_unknown_name_is_an_error() {
        assert!(by_name("luck").is_err());
    }
}
