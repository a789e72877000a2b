//! Calls of cargo on the native packages of the workspace, and on those for the browser.

use std::process::Command;

use anyhow::Result;

use crate::process;
use crate::tools::{self, WASM_TARGET};
use crate::workspace::Workspace;

/// All native packages.
///
/// Always all of them: with fewer packages cargo selects other features of common dependencies and builds
/// these once more.
const NATIVE: [&str; 3] = ["--workspace", "--exclude", "motorlink-worker"];

/// The page and the worker; always both, as above.
const WASM: [&str; 6] = [
    "--target",
    WASM_TARGET,
    "--package",
    "motorlink",
    "--package",
    "motorlink-worker",
];

/// With the tests of the page in a browser.
const PAGE_TESTS: [&str; 2] = ["--features", "motorlink/page-tests"];

/// Cargo at the top of the workspace.
pub fn command(workspace: &Workspace, args: &[&str]) -> Command {
    let mut cargo = process::cargo();
    cargo.current_dir(workspace.root()).args(args);
    cargo
}

/// Cargo on all native packages.
pub fn native(workspace: &Workspace, subcommand: &str, args: &[&str]) -> Command {
    command(workspace, &[&[subcommand], &NATIVE[..], args].concat())
}

/// Cargo on the page and the worker.
pub fn wasm(workspace: &Workspace, subcommand: &str, args: &[&str]) -> Result<Command> {
    tools::ensure_wasm_target()?;
    Ok(command(
        workspace,
        &[&[subcommand], &WASM[..], args].concat(),
    ))
}

/// Cargo on the page and the worker, with their tests.
pub fn wasm_tests(workspace: &Workspace, subcommand: &str, args: &[&str]) -> Result<Command> {
    wasm(workspace, subcommand, &[&PAGE_TESTS[..], args].concat())
}

/// For `crates/ros`, a workspace of its own.
pub fn of_ros(workspace: &Workspace, subcommand: &str) -> Command {
    let mut command = command(workspace, &[subcommand]);
    command.args(["--manifest-path", "crates/ros/Cargo.toml"]);
    command.env("CARGO_TARGET_DIR", workspace.root().join("target/ros"));
    command
}
