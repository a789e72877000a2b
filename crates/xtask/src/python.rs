//! The Python packages of the official readers, in fixed versions, installed once.

use std::{fs, path::PathBuf, process::Command};

use anyhow::{Context, Result, bail};

use crate::cargo;
use crate::process;
use crate::tools::cache_dir;
use crate::workspace::Workspace;

/// The reader of MCAP files with the decoder that ROS 2 users add, and a validator of JSON schemas.
const PACKAGES: [&str; 3] = [
    "mcap==1.6.0",
    "mcap-ros2-support==0.6.0",
    "jsonschema==4.26.0",
];

/// The name of the environment: another set of packages is another one.
const ENVIRONMENT: &str = "session-readers-1";

/// Lets the official Python reader read a session file, and validate it.
pub fn read_session(workspace: &Workspace) -> Result<()> {
    let python = ensure()?;
    let args = [
        "--package",
        "motorlink-session",
        "--test",
        "official_python",
    ];
    let mut test = cargo::command(workspace, &[&["test", "--quiet"][..], &args].concat());
    test.args(["--", "--ignored"])
        .env("MOTORLINK_PYTHON", python);
    process::run(&mut test)
}

/// The Python of a virtual environment with these packages; makes it if it is missing.
fn ensure() -> Result<PathBuf> {
    let tools = cache_dir()?.join("tools");
    let dir = tools.join(ENVIRONMENT);
    let program = if cfg!(windows) {
        "Scripts/python.exe"
    } else {
        "bin/python"
    };
    // Written last: an incomplete environment is never used. It cannot be moved, so it is made in place.
    let complete = dir.join("complete");
    if complete.is_file() {
        return Ok(dir.join(program));
    }
    if process::output_of("python3", &["--version"]).is_none() {
        bail!(
            "python3 is missing: install Python 3.9 or newer (Debian: apt-get install python3-venv)"
        );
    }
    println!(
        "installing {} into {} (once)",
        PACKAGES.join(", "),
        dir.display()
    );
    let _ = fs::remove_dir_all(&dir);
    fs::create_dir_all(&tools).with_context(|| format!("making {}", tools.display()))?;
    process::run(Command::new("python3").args(["-m", "venv"]).arg(&dir))?;
    let mut pip = Command::new(dir.join(program));
    pip.args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
    ]);
    process::run(pip.args(PACKAGES))?;
    fs::write(&complete, PACKAGES.join("\n")).with_context(|| format!("{}", complete.display()))?;
    Ok(dir.join(program))
}
