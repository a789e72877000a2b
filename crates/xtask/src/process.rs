//! Starting other programs.

use std::env;
use std::io::{BufRead, BufReader};
use std::process::{Command, ExitStatus, Stdio};
use std::thread;

use anyhow::{Context, Result};

use crate::failure::ChildFailed;

/// Variables that `cargo run` sets for this program and that another cargo must not see: build scripts
/// watch some of them and would run again after each change between a user's cargo and this one.
const OF_OUR_PACKAGE: [&str; 4] = [
    "CARGO_PKG_",
    "CARGO_MANIFEST_",
    "CARGO_BIN_",
    "CARGO_CRATE_",
];

/// Flags of the environment replace those in `.cargo/config.toml`, which the wasm code needs, and
/// different flags mean a second build of every dependency.
const FLAGS: [&str; 2] = ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS"];

/// The cargo that started this program.
pub fn cargo() -> Command {
    let program = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    without_our_package(Command::new(program))
}

/// A program that calls cargo, without the variables that name the package of this program: build scripts that read them
/// would run again, and cargo would compile again what depends on them.
pub fn without_our_package(mut command: Command) -> Command {
    for (name, _) in env::vars_os() {
        let text = name.to_string_lossy();
        let ours = OF_OUR_PACKAGE.iter().any(|prefix| text.starts_with(prefix));
        if ours || FLAGS.contains(&text.as_ref()) {
            command.env_remove(&name);
        }
    }
    command
}

/// The same command, it and each program that it starts with at most so many bytes of address space, where the system can
/// limit it. Needs prlimit, of util-linux.
pub fn within_address_space(command: &Command, bytes: u64) -> Command {
    let mut limited = Command::new("prlimit");
    if cfg!(target_os = "linux") {
        limited.arg(format!("--as={bytes}"));
        limited.arg(command.get_program());
    } else {
        limited = Command::new(command.get_program());
    }
    like(limited, command)
}

/// A command with the arguments, the variables and the folder of another one.
pub fn like(mut command: Command, other: &Command) -> Command {
    command.args(other.get_args());
    for (name, value) in other.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    if let Some(dir) = other.get_current_dir() {
        command.current_dir(dir);
    }
    command
}

/// Runs a program to its end and passes its output on.
pub fn run(command: &mut Command) -> Result<()> {
    let status = command
        .status()
        .with_context(|| format!("cannot start `{}`", text_of(command)))?;
    succeeded(command, status)
}

/// Runs a program while `act` runs, and waits for both.
pub fn run_while<T>(command: &mut Command, act: impl FnOnce() -> Result<T>) -> Result<T> {
    let mut child = command
        .spawn()
        .with_context(|| format!("cannot start `{}`", text_of(command)))?;
    let done = act();
    // In any case: no program goes on after a failure.
    let status = child
        .wait()
        .with_context(|| format!("lost `{}`", text_of(command)))?;
    let done = done?;
    succeeded(command, status)?;
    Ok(done)
}

/// Runs programs at the same time, prints the output of each when it ends, and waits for all. Returns what each of them
/// printed, and whether it succeeded.
pub fn run_all(commands: &mut [Command]) -> Vec<(String, Result<()>)> {
    thread::scope(|scope| {
        let run = |command| scope.spawn(move || run_captured(command));
        let running: Vec<_> = commands.iter_mut().map(run).collect();
        let joined = running.into_iter().map(|thread| {
            thread
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        });
        joined.collect()
    })
}

/// Runs a program to its end, and prints its output then. Returns what it printed, and whether it succeeded.
pub fn run_captured(command: &mut Command) -> (String, Result<()>) {
    let output = match command.output() {
        Ok(output) => output,
        Err(error) => {
            let context = format!("cannot start `{}`", text_of(command));
            return (String::new(), Err(error).context(context));
        }
    };
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    print!("{printed}");
    eprint!("{}", String::from_utf8_lossy(&output.stderr));
    (printed, succeeded(command, output.status))
}

/// An error where the program failed.
fn succeeded(command: &Command, status: ExitStatus) -> Result<()> {
    if status.success() {
        return Ok(());
    }
    Err(ChildFailed {
        command: text_of(command),
        code: status.code(),
    }
    .into())
}

/// Runs a program to its end, passes its output on, and calls `on_line` with each line.
pub fn run_with_lines(command: &mut Command, mut on_line: impl FnMut(&str)) -> Result<()> {
    let mut child = command
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start `{}`", text_of(command)))?;
    if let Some(printed) = child.stdout.take() {
        for line in BufReader::new(printed).lines() {
            let line = line.with_context(|| format!("cannot read `{}`", text_of(command)))?;
            println!("{line}");
            on_line(&line);
        }
    }
    let status = child.wait()?;
    succeeded(command, status)
}

/// Runs a program to its end and returns its output.
pub fn output(command: &mut Command) -> Result<String> {
    let output = command
        .stderr(Stdio::inherit())
        .output()
        .with_context(|| format!("cannot start `{}`", text_of(command)))?;
    succeeded(command, output.status)?;
    String::from_utf8(output.stdout)
        .with_context(|| format!("`{}` printed something other than text", text_of(command)))
}

/// The output of a program, if it exists and succeeds.
pub fn output_of(program: &str, args: &[&str]) -> Option<String> {
    let output = Command::new(program)
        .args(args)
        .stderr(Stdio::null())
        .output()
        .ok()?;
    if !output.status.success() {
        return None;
    }
    String::from_utf8(output.stdout).ok()
}

/// The command as a user would type it.
fn text_of(command: &Command) -> String {
    let program = std::path::Path::new(command.get_program());
    let name = program.file_name().unwrap_or(command.get_program());
    std::iter::once(name)
        .chain(command.get_args())
        .map(|word| word.to_string_lossy())
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use anyhow::bail;

    use super::*;

    #[test]
    fn a_command_is_named_without_its_directory() {
        let mut command = Command::new("/opt/bin/cargo");
        command.args(["test", "-p", "xtask"]);
        assert_eq!(text_of(&command), "cargo test -p xtask");
    }

    #[test]
    fn variables_of_this_package_are_not_passed_on() {
        let command = cargo();
        let removed = |name: &str| {
            command
                .get_envs()
                .any(|(key, value)| key == name && value.is_none())
        };
        assert!(removed("CARGO_PKG_NAME"));
        assert!(removed("CARGO_MANIFEST_DIR"));
    }

    #[test]
    fn a_missing_program_has_no_output() {
        assert_eq!(output_of("motorlink-no-such-program", &[]), None);
    }

    #[test]
    fn a_failure_of_either_is_an_error() {
        let [mut good, mut bad] = [0, 3].map(|code| {
            let mut shell = Command::new("sh");
            shell.args(["-c", &format!("exit {code}")]);
            shell
        });
        assert_eq!(run_while(&mut good, || Ok(7)).unwrap(), 7);
        assert!(run_while(&mut bad, || Ok(7)).is_err());
        let fails = || -> Result<()> { bail!("the other") };
        let error = run_while(&mut good, fails).unwrap_err();
        assert_eq!(error.to_string(), "the other");
    }
}
