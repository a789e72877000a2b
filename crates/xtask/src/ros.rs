//! `crates/ros`: a workspace of its own, so that nobody compiles Zenoh for the page or for the command.

use std::process::Command;

use anyhow::Result;

use crate::cargo;
use crate::failure::refusal_of_flags;
use crate::process;
use crate::python;
use crate::tools;
use crate::workspace::Workspace;

const MANIFEST: [&str; 2] = ["--manifest-path", "crates/ros/Cargo.toml"];

/// Runs its lints and its tests, against the command `motorlink` and against other implementations of ROS messages.
pub fn test(workspace: &Workspace) -> Result<()> {
    let python = python::with_rosbags()?;
    // The command comes with its tests.
    let motorlink = ["--no-run", "--quiet", "--test", "command"];
    process::run(&mut cargo::native(workspace, "test", &motorlink))?;
    let lints = [
        "--all-targets",
        "--features",
        "bench",
        "--",
        "--deny",
        "warnings",
    ];
    process::run(of_ros(workspace, "clippy").args(lints))?;
    // The wheels turn in real time: one test at a time.
    let all = ["--", "--test-threads", "1", "--nocapture"];
    process::run(
        of_ros(workspace, "test")
            .args(all)
            .env("MOTORLINK_PYTHON", python)
            .env("MOTORLINK", workspace.root().join("target/debug/motorlink")),
    )
}

/// Measures a fleet of virtual robots on this machine, through a real router.
pub fn fleet(workspace: &Workspace, args: &[String]) -> Result<()> {
    let zenohd = tools::ensure_zenohd()?;
    let optimised = ["--release", "--bins", "--features", "bench"];
    process::run(of_ros(workspace, "build").args(optimised))?;
    let built = workspace.root().join("target/ros/release");
    let mut measure = Command::new(built.join("fleet-bench"));
    measure.arg("--zenohd").arg(zenohd);
    measure.arg("--fleet").arg(built.join("motorlink-fleet"));
    process::run(measure.args(args)).map_err(refusal_of_flags)
}

/// Fails on a file that rustfmt would write in another way.
pub fn check_format(workspace: &Workspace) -> Result<()> {
    process::run(of_ros(workspace, "fmt").arg("--check"))
}

fn of_ros(workspace: &Workspace, subcommand: &str) -> Command {
    let mut command = cargo::command(workspace, &[subcommand]);
    command.args(MANIFEST);
    command.env("CARGO_TARGET_DIR", workspace.root().join("target/ros"));
    command
}
