//! The figures of `crates/experiments`, as `docs/experiments.md` has them.

use anyhow::Result;

use crate::cargo;
use crate::process;
use crate::workspace::Workspace;

/// Prints a row for each figure, and runs the generated programs.
pub fn show(workspace: &Workspace) -> Result<()> {
    let figures = ["--test", "figures", "--", "--ignored", "--nocapture"];
    let package = ["test", "--quiet", "--package", "motorlink-experiments"];
    let figures = [&package[..], &figures[..]].concat();
    process::run(&mut cargo::command(workspace, &figures))?;
    let package = ["test", "--package", "virtual-motor"];
    let programs = [&package[..], &["--test", "generated_programs"]].concat();
    process::run(&mut cargo::command(workspace, &programs))
}
