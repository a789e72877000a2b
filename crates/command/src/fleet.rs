//! `motorlink fleet`: the robots in a Zenoh network. A program of its own brings Zenoh, and this one starts it.

use std::{env, ffi::OsString, io, process::Command};

use crate::failure::Failure;

const PROGRAM: &str = "motorlink-fleet";

/// The program: beside this one, or on the path.
pub fn program() -> Command {
    let name = format!("{PROGRAM}{}", env::consts::EXE_SUFFIX);
    let beside = env::current_exe().map(|this| this.with_file_name(&name));
    match beside {
        Ok(beside) if beside.is_file() => Command::new(beside),
        _ => Command::new(name),
    }
}

/// For `map_err`: the program does not start.
#[expect(clippy::needless_pass_by_value, reason = "as `map_err` gives it")]
pub fn not_started(error: io::Error) -> Failure {
    Failure::NotDone(match error.kind() {
        io::ErrorKind::NotFound => format!(
            "{PROGRAM} is neither beside this program nor on the path: `cargo install --path crates/ros` installs it"
        ),
        _ => format!("{PROGRAM}: {error}"),
    })
}

/// Becomes the program, with these arguments.
///
/// # Errors
/// It is missing.
#[cfg(unix)]
pub fn run(arguments: &[OsString]) -> Result<(), Failure> {
    use std::os::unix::process::CommandExt as _;
    Err(not_started(program().args(arguments).exec()))
}

/// Runs the program with these arguments.
///
/// # Errors
/// It is missing, or has not done what was asked.
#[cfg(not(unix))]
pub fn run(arguments: &[OsString]) -> Result<(), Failure> {
    let ended = program().args(arguments).status().map_err(not_started)?;
    if ended.success() {
        Ok(())
    } else {
        Err(Failure::NotDone(format!("{PROGRAM} ended with {ended}")))
    }
}
