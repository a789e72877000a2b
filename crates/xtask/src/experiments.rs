//! The figures of `crates/experiments`, as `docs/experiments.md` has them.

use anyhow::Result;

use crate::cargo;
use crate::process;
use crate::workspace::Workspace;

/// Worlds with random sequences. A thousand take a minute and a half on two cores.
const SEQUENCE_SEEDS: &str = "10000";

/// Prints a row for each figure, runs the generated programs, and checks the files of a robot.
pub fn show(workspace: &Workspace) -> Result<()> {
    let package = ["test", "--quiet", "--package", "motorlink-experiments"];
    let tests = [
        "--test",
        "experiments",
        "--",
        "--include-ignored",
        "--nocapture",
    ];
    let mut figures = cargo::command(workspace, &[&package[..], &tests[..]].concat());
    process::run(figures.args(["figures::", "coverage::", "largest_run"]))?;
    let package = ["test", "--quiet", "--package", "motorlink-fault-simulation"];
    let sequences = [&package[..], &["--test", "sequences", "--", "--nocapture"]].concat();
    let mut sequences = cargo::command(workspace, &sequences);
    process::run(sequences.env("SEQUENCE_SEEDS", SEQUENCE_SEEDS))?;
    let package = ["test", "--package", "motorlink-command"];
    let programs = [
        &package[..],
        &["--test", "command", "generated_programs", "ros2_files"],
    ]
    .concat();
    process::run(&mut cargo::command(workspace, &programs))
}
