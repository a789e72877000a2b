//! `crates/ros`: a workspace of its own, so that nobody compiles Zenoh for the page or for the command.

use anyhow::Result;

use crate::cargo;
use crate::process;
use crate::python;
use crate::workspace::Workspace;

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
    process::run(cargo::of_ros(workspace, "clippy").args(lints))?;
    // The wheels turn in real time: one test at a time.
    let all = ["--", "--test-threads", "1", "--nocapture"];
    process::run(
        cargo::of_ros(workspace, "test")
            .args(all)
            .env("MOTORLINK_PYTHON", python)
            .env("MOTORLINK", workspace.root().join("target/debug/motorlink")),
    )
}

/// Fails on a file that rustfmt would write in another way.
pub fn check_format(workspace: &Workspace) -> Result<()> {
    process::run(cargo::of_ros(workspace, "fmt").arg("--check"))
}
