//! `cargo xtask check`: the checks that do not run the product, the quick ones first.

use std::process::Command;

use anyhow::Result;

use crate::cargo;
use crate::claims;
use crate::dependencies;
use crate::invariants;
use crate::layers;
use crate::process;
use crate::ros;
use crate::suite::{Step, Suite};
use crate::translations;

/// After `--`, for lints only: in RUSTFLAGS it would rebuild every dependency.
const DENY_WARNINGS: [&str; 3] = ["--", "-D", "warnings"];

/// The page is checked for the browser, where it runs.
const NO_PAGE: [&str; 2] = ["--exclude", "motorlink"];

/// Nobody reads the documentation of these, and their many dependencies would be compiled for it alone.
const NO_TEST_PROGRAMS: [&str; 4] = [
    "--exclude",
    "motorlink-fuzz-checks",
    "--exclude",
    "end-to-end",
];

/// Every check, in order.
pub static SUITE: Suite = Suite {
    name: "check",
    steps: &[
        Step {
            name: "format",
            about: "the sources are formatted",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: false,
            run: |workspace| {
                let args = ["fmt", "--all", "--check"];
                process::run(&mut cargo::command(workspace, &args))?;
                ros::check_format(workspace)
            },
        },
        Step {
            name: "translations",
            about: "every message of the code has its translations",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: false,
            run: |workspace| translations::update(workspace, true),
        },
        Step {
            name: "layers",
            about: "no arrow between modules or crates points up, and no two files use each other",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: false,
            run: layers::check,
        },
        Step {
            name: "invariants",
            about: "every test and file that docs/invariants.md names exists",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: false,
            run: invariants::check,
        },
        Step {
            name: "claims",
            about: "no text says that a wheel coasts because frames cease",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: false,
            run: claims::check,
        },
        Step {
            name: "dependencies",
            about: "each dependency is locked, licensed, from the registry, and there once",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: false,
            run: dependencies::check,
        },
        Step {
            name: "advisories",
            about: "no dependency has a known vulnerability; fetches the list of them",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: true,
            run: dependencies::check_advisories,
        },
        Step {
            name: "clippy",
            about: "no warnings in the native code",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: false,
            run: |workspace| {
                let args = [&["--all-targets"], &NO_PAGE[..], &DENY_WARNINGS].concat();
                process::run(&mut cargo::native(workspace, "clippy", &args))
            },
        },
        Step {
            name: "clippy-wasm",
            about: "no warnings in the code for the browser, tests included",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: false,
            run: |workspace| {
                let targets = ["--lib", "--bins", "--tests"];
                let fuzzed = ["--features", "motorlink/fuzzing"];
                let args = [&targets[..], &fuzzed, &DENY_WARNINGS].concat();
                process::run(&mut cargo::wasm_tests(workspace, "clippy", &args)?)
            },
        },
        Step {
            name: "doc",
            about: "the documentation builds without warnings",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: false,
            run: |workspace| {
                let args = [&["--no-deps"], &NO_PAGE[..], &NO_TEST_PROGRAMS].concat();
                strict_doc(cargo::native(workspace, "doc", &args))?;
                strict_doc(cargo::wasm(workspace, "doc", &["--no-deps"])?)
            },
        },
    ],
};

fn strict_doc(mut command: Command) -> Result<()> {
    process::run(command.env("RUSTDOCFLAGS", "-D warnings"))
}
