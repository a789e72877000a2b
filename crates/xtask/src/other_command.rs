//! Compares the command with that of another project: every line of its README that ends by itself, on the same virtual
//! motor.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};

use crate::process;
use crate::tables::Rows;
use crate::tools;

/// The other command: a tool for the same motor, with its version.
const OTHER: (&str, &str) = ("m0601-cli", "0.1.1");
/// Runs of each line; the median counts. A line that takes longer than [`LONG`] runs once.
const RUNS: usize = 5;
const LONG: Duration = Duration::from_secs(5);

/// Lines that both understand, and how many times sooner ours must end.
const LINES: [(&[&str], f64); 8] = [
    (&["scan"], 1.0),
    (&["scan", "--full"], 1.0),
    (&["info", "--id", "1"], 1.0),
    (
        &[
            "drive", "velocity", "--rpm", "100", "--secs", "1", "--id", "1",
        ],
        1.0,
    ),
    (
        &[
            "drive", "current", "--amps", "0.2", "--secs", "1", "--id", "1",
        ],
        1.0,
    ),
    (
        &[
            "drive", "position", "--deg", "90", "--secs", "1", "--id", "1",
        ],
        1.0,
    ),
    (&["raw", "01 74 00 00 00 00 00 00 00", "--id", "1"], 1.0),
    (&["set-id", "--new", "2", "--yes"], 10.0),
];

/// Runs each line with both, and adds a row for it.
pub fn compare(ours: &Path, folder: &Path, rows: &mut Rows) -> Result<()> {
    let other = ensure_other()?;
    for (line, factor) in LINES {
        let start = || VirtualMotor::start(ours, folder);
        let own = median(start, ours, line)?;
        let others = median(start, &other, line)?;
        let is_reached = own.as_secs_f64() * factor <= others.as_secs_f64();
        let must = if factor > 1.0 {
            format!("{factor} times sooner")
        } else {
            "at least as soon".to_owned()
        };
        let (name, version) = OTHER;
        let row = format!(
            "| `motorlink {}`, beside {name} {version} | {must} | {:.2} s; {:.2} s | {} |",
            line.join(" "),
            own.as_secs_f64(),
            others.as_secs_f64(),
            if is_reached { "yes" } else { "NO" }
        );
        println!("{row}");
        rows.add_line(&row);
    }
    Ok(())
}

/// How long a program takes for a line, on a virtual motor of its own.
fn median(
    start: impl Fn() -> Result<VirtualMotor>,
    program: &Path,
    line: &[&str],
) -> Result<Duration> {
    let mut times = Vec::new();
    while times.len() < RUNS && times.last().is_none_or(|time| *time < LONG) {
        let motor = start()?;
        let mut command = Command::new(program);
        command.args(line).arg("--port").arg(&motor.port);
        command.env("XDG_STATE_HOME", &motor.folder);
        let begun = Instant::now();
        let output = command.stdin(Stdio::null()).output()?;
        times.push(begun.elapsed());
        let said = String::from_utf8_lossy(&output.stderr);
        ensure!(
            output.status.success(),
            "{} {}: {said}",
            program.display(),
            line.join(" ")
        );
    }
    times.sort_unstable();
    times.get(times.len() / 2).copied().context("no run")
}

/// A virtual motor with ID 1 on a pseudo-terminal.
struct VirtualMotor {
    process: Child,
    port: PathBuf,
    folder: PathBuf,
}

impl VirtualMotor {
    /// Its port and the files of the programs are in this folder.
    fn start(program: &Path, folder: &Path) -> Result<Self> {
        if fs::exists(folder)? {
            fs::remove_dir_all(folder)?;
        }
        fs::create_dir_all(folder)?;
        let port = folder.join("port");
        let mut command = Command::new(program);
        command.args(["virtual", "--link"]).arg(&port);
        let mut process = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()?;
        let out = process.stdout.take().context("no output")?;
        let mut ready = String::new();
        BufReader::new(out).read_line(&mut ready)?;
        ensure!(ready.starts_with("ready"), "no virtual motor: {ready}");
        Ok(Self {
            process,
            port,
            folder: folder.to_owned(),
        })
    }
}

impl Drop for VirtualMotor {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Builds the other command once.
fn ensure_other() -> Result<PathBuf> {
    let (name, version) = OTHER;
    let root = tools::cache_dir()?
        .join("tools")
        .join(format!("{name}-{version}"));
    let program = root.join("bin").join("m0601");
    if fs::exists(&program)? {
        return Ok(program);
    }
    let mut install = process::cargo();
    install.args(["install", name, "--version", version, "--locked", "--root"]);
    process::run(install.arg(&root))?;
    Ok(program)
}
