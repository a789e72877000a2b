//! The bench of a fleet.

use std::process::Command;

use anyhow::Result;

use crate::cargo;
use crate::failure::refusal_of_flags;
use crate::process;
use crate::tools;
use crate::workspace::Workspace;

/// Measures a fleet of virtual robots on this machine, through a real router.
pub fn bench(workspace: &Workspace, args: &[String]) -> Result<()> {
    let zenohd = tools::ensure_zenohd()?;
    let optimised = ["--release", "--bins", "--features", "bench"];
    process::run(cargo::of_ros(workspace, "build").args(optimised))?;
    let built = workspace.root().join("target/ros/release");
    let mut measure = Command::new(built.join("fleet-bench"));
    measure.arg("--zenohd").arg(zenohd);
    measure.arg("--fleet").arg(built.join("motorlink-fleet"));
    process::run(measure.args(args)).map_err(refusal_of_flags)
}
