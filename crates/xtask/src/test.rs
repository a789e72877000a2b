//! `cargo xtask test`: the tests, from the native ones to the page in a real browser.

use anyhow::Result;

use crate::bench;
use crate::browser;
use crate::cargo::{self, NATIVE};
use crate::process;
use crate::site::{self, Profile};
use crate::stories;
use crate::suite::{Step, Suite};
use crate::tools;
use crate::workspace::Workspace;

/// Every step, in order.
pub static SUITE: Suite = Suite(&[
    Step {
        name: "native",
        about: "tests of the native code",
        needs: &[],
        run: |workspace| {
            let rest = ["--exclude", "end-to-end"];
            let args = [&["test", "--quiet"], &NATIVE[..], &rest].concat();
            cargo::run(workspace, &args)
        },
    },
    Step {
        name: "page",
        about: "tests of the page's pure parts, natively",
        needs: &[],
        run: |workspace| {
            let args = ["test", "--quiet", "--package", "motorlink", "--lib"];
            cargo::run(workspace, &args)
        },
    },
    Step {
        name: "wasm",
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
]);

fn test_wasm(workspace: &Workspace) -> Result<()> {
    tools::ensure_wasm_target()?;
    let runner = tools::ensure_wasm_bindgen(workspace)?.test_runner;
    let browser = browser::ensure()?;
    // Not the examples in the documentation: those of a page cannot run alone.
    let mut command = cargo::wasm_command(workspace, "test", &["--lib", "--bins", "--tests"]);
    command
        .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUNNER", runner)
        // In seconds, for all tests of a program together; the runner's own 20 are too few.
        .env("WASM_BINDGEN_TEST_TIMEOUT", "300")
        .env("CHROMEDRIVER", browser.driver);
    process::run(&mut command)
}
