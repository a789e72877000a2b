//! Calls of cargo on the workspace: on what runs natively, and on what runs in the browser.

use std::process::Command;

use anyhow::Result;

use crate::process;
use crate::tools::{self, WASM_TARGET};
use crate::workspace::Workspace;

/// Leaves what only runs in the browser out of a call on the whole workspace.
pub const NATIVE: [&str; 5] = [
    "--workspace",
    "--exclude",
    "motorlink",
    "--exclude",
    "motorlink-worker",
];

/// Cargo with its flags, at the top of the workspace.
pub fn command(workspace: &Workspace, args: &[&str]) -> Command {
    let mut cargo = process::cargo();
    cargo.current_dir(workspace.root()).args(args);
    cargo
}

/// Runs cargo at the top of the workspace.
pub fn run(workspace: &Workspace, args: &[&str]) -> Result<()> {
    process::run(&mut command(workspace, args))
}

/// Cargo on the page and the worker.
///
/// Always on both at once: alone each would get its own selection of features, and their common
/// dependencies would be built again.
pub fn wasm_command(workspace: &Workspace, subcommand: &str, args: &[&str]) -> Command {
    let packages = ["--package", "motorlink", "--package", "motorlink-worker"];
    let target = ["--target", WASM_TARGET];
    command(
        workspace,
        &[&[subcommand], &target[..], &packages, args].concat(),
    )
}

/// Runs cargo on the page and the worker.
pub fn run_wasm(workspace: &Workspace, subcommand: &str, args: &[&str]) -> Result<()> {
    tools::ensure_wasm_target()?;
    process::run(&mut wasm_command(workspace, subcommand, args))
}
