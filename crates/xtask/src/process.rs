//! Starting other programs.

use std::env;
use std::io::{BufRead, BufReader};
use std::process::{Command, ExitStatus, Stdio};
use std::thread;

use anyhow::{Context, Result};

use crate::failure::ChildFailed;

/// Variables that `cargo run` sets for us and that another cargo must not see: build scripts watch
/// some of them, and would rebuild whenever a person and we take turns.
const OF_OUR_PACKAGE: [&str; 4] = [
    "CARGO_PKG_",
    "CARGO_MANIFEST_",
    "CARGO_BIN_",
    "CARGO_CRATE_",
];

/// Flags from outside replace those in `.cargo/config.toml`, without which the wasm code does not
/// compile, and different flags mean a second copy of every dependency.
const FLAGS: [&str; 2] = ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS"];

/// Cargo, as the one that started us.
pub fn cargo() -> Command {
    let program = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(program);
    for (name, _) in env::vars_os() {
        let text = name.to_string_lossy();
        let ours = OF_OUR_PACKAGE.iter().any(|prefix| text.starts_with(prefix));
        if ours || FLAGS.contains(&text.as_ref()) {
            command.env_remove(&name);
        }
    }
    command
}

/// Runs a program to its end, its output going where ours goes.
pub fn run(command: &mut Command) -> Result<()> {
    let status = command
        .status()
        .with_context(|| format!("cannot start `{}`", words(command)))?;
    succeeded(command, status)
}

/// Runs a program while something else is done, and waits for both.
pub fn run_beside<T>(command: &mut Command, act: impl FnOnce() -> Result<T>) -> Result<T> {
    let mut child = command
        .spawn()
        .with_context(|| format!("cannot start `{}`", words(command)))?;
    let done = act();
    // In any case: nothing of ours goes on behind a failure.
    let status = child
        .wait()
        .with_context(|| format!("lost `{}`", words(command)))?;
    let done = done?;
    succeeded(command, status)?;
    Ok(done)
}

/// Runs programs at the same time, prints what each has printed when it ends, and waits for all.
pub fn run_all(commands: &mut [Command]) -> Result<()> {
    let outputs = thread::scope(|scope| {
        let run = |command| scope.spawn(move || run_captured(command));
        let running: Vec<_> = commands.iter_mut().map(run).collect();
        let joined = running.into_iter().map(|thread| {
            thread
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        });
        joined.collect::<Vec<_>>()
    });
    outputs.into_iter().collect()
}

fn run_captured(command: &mut Command) -> Result<()> {
    let output = command
        .output()
        .with_context(|| format!("cannot start `{}`", words(command)))?;
    print!("{}", String::from_utf8_lossy(&output.stdout));
    eprint!("{}", String::from_utf8_lossy(&output.stderr));
    succeeded(command, output.status)
}

/// An error where the program failed.
fn succeeded(command: &Command, status: ExitStatus) -> Result<()> {
    if status.success() {
        return Ok(());
    }
    Err(ChildFailed {
        command: words(command),
        code: status.code(),
    }
    .into())
}

/// Runs a program to its end, its output going where ours goes, and hears each line of it.
pub fn run_and_hear(command: &mut Command, mut hear: impl FnMut(&str)) -> Result<()> {
    let mut child = command
        .stdout(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start `{}`", words(command)))?;
    if let Some(printed) = child.stdout.take() {
        for line in BufReader::new(printed).lines() {
            let line = line.with_context(|| format!("cannot read `{}`", words(command)))?;
            println!("{line}");
            hear(&line);
        }
    }
    let status = child.wait()?;
    succeeded(command, status)
}

/// Runs a program to its end and gives what it printed.
pub fn output(command: &mut Command) -> Result<String> {
    let output = command
        .stderr(Stdio::inherit())
        .output()
        .with_context(|| format!("cannot start `{}`", words(command)))?;
    succeeded(command, output.status)?;
    String::from_utf8(output.stdout)
        .with_context(|| format!("`{}` printed something other than text", words(command)))
}

/// What a program printed, where it exists and succeeds.
pub fn ask(program: &str, args: &[&str]) -> Option<String> {
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

/// The command as a person would type it.
fn words(command: &Command) -> String {
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
        assert_eq!(words(&command), "cargo test -p xtask");
    }

    #[test]
    fn what_cargo_tells_us_of_our_package_goes_no_further() {
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
    fn a_missing_program_answers_nothing() {
        assert_eq!(ask("motorlink-no-such-program", &[]), None);
    }

    #[test]
    fn whichever_of_two_fails_is_told() {
        let [mut good, mut bad] = [0, 3].map(|code| {
            let mut shell = Command::new("sh");
            shell.args(["-c", &format!("exit {code}")]);
            shell
        });
        assert_eq!(run_beside(&mut good, || Ok(7)).unwrap(), 7);
        assert!(run_beside(&mut bad, || Ok(7)).is_err());
        let fails = || -> Result<()> { bail!("the other") };
        let error = run_beside(&mut good, fails).unwrap_err();
        assert_eq!(error.to_string(), "the other");
    }
}
