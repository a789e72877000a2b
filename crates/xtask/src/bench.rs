//! The test bench: virtual motors on a serial line, a real Chromium, and the measurements on it.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};

use crate::browser::{self, Browser};
use crate::cargo;
use crate::failure::refusal_of_flags;
use crate::fleet;
use crate::other_command;
use crate::other_hosts;
use crate::process;
use crate::site;
use crate::site_file::Profile;
use crate::tables::Rows;
use crate::workspace::Workspace;

/// For measurements: these programs simulate a motor, which answers after 0.6 ms.
const PROFILE: &str = "bench-native";

/// How the programs of the bench are built.
#[derive(Clone, Copy, Debug)]
pub enum Speed {
    /// With the tests, whose dependencies they share. The simulation itself is optimised there too.
    QuickToBuild,
    /// Fully optimised, for measurements.
    QuickToRun,
}

impl Speed {
    /// Cargo's output directory for this build.
    fn target_dir(self) -> &'static str {
        match self {
            Self::QuickToBuild => "debug",
            Self::QuickToRun => PROFILE,
        }
    }
}

/// Seeds of the full scans; one run in a thousand may miss a motor.
const SCAN_SEEDS: &str = "1000";

/// Builds the command, which has the virtual motors, and the library that shows Chromium its serial line.
pub fn build_programs(workspace: &Workspace) -> Result<()> {
    let mut cargo = cargo::command(workspace, &["build", "--profile", PROFILE]);
    cargo.args(["--package", "motorlink-command", "--package", "udev-shim"]);
    process::run(&mut cargo)
}

/// Sets the environment variables through which a program of `end-to-end` finds its files.
pub fn set_paths(command: &mut Command, workspace: &Workspace, browser: &Browser, speed: Speed) {
    let built = workspace.target().join(speed.target_dir());
    command
        .current_dir(workspace.root())
        .env("MOTORLINK_UDEV_SHIM", udev_shim(&built))
        .env("MOTORLINK_COMMAND", motorlink(&built))
        .env("MOTORLINK_DIST", workspace.dist())
        .env("MOTORLINK_CHROMIUM", &browser.chromium)
        .env("CHROMEDRIVER", &browser.driver);
}

fn motorlink(built: &Path) -> PathBuf {
    built.join(format!("motorlink{}", std::env::consts::EXE_SUFFIX))
}

fn udev_shim(built: &Path) -> PathBuf {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    built.join(format!("{DLL_PREFIX}udev_shim{DLL_SUFFIX}"))
}

/// The parts that can be measured alone: programs of `end-to-end`, and benchmarks without a browser.
const PARTS: [&str; 12] = [
    "start",
    "figures",
    "instruments",
    "wire",
    "scans",
    "stops",
    "pure",
    "session",
    "recordings",
    "driver",
    "commands",
    "remote",
];

/// The document with the measured figures.
const TABLE: &str = "docs/performance.md";

/// Measures the page's performance figures, prints them, and updates the table in [`TABLE`].
///
/// The first of `args` may name a part; the rows of other parts stay. `fleet` is measured alone only, and prints: `docs/fleet.md` has
/// its figures.
pub fn figures(workspace: &Workspace, args: &[String]) -> Result<()> {
    // These need neither the page nor a browser, which take minutes to build.
    match args {
        [part] if part == "session" => return alone(workspace, &mut session(workspace)),
        [part] if part == "stops" => return alone(workspace, &mut stops(workspace)),
        [part, args @ ..] if part == "fleet" => return fleet::bench(workspace, args),
        [part] if part == "driver" => {
            build_programs(workspace)?;
            return alone(workspace, &mut driver(workspace));
        }
        [part] if part == "commands" => {
            build_programs(workspace)?;
            let mut rows = Rows::default();
            let compared = compare_commands(workspace, &mut rows);
            rows.write_into(&workspace.root().join(TABLE), "bench")?;
            return compared;
        }
        _ => {}
    }
    let (browser, dist) = prepare(workspace)?;
    let (only, args) = match args {
        [part, rest @ ..] if PARTS.contains(&part.as_str()) => (Some(part.as_str()), rest),
        all => (None, all),
    };
    let mut rows = Rows::default();
    let mut failed = Ok(());
    for part in PARTS
        .into_iter()
        .filter(|part| only.is_none_or(|only| only == *part))
    {
        if part == "commands" {
            failed = failed.and(compare_commands(workspace, &mut rows));
            continue;
        }
        let mut command = match part {
            "scans" => full_scans(workspace),
            "stops" => stops(workspace),
            "pure" => pure_parts(workspace),
            "session" => session(workspace),
            "driver" => driver(workspace),
            program => program_of_bench(workspace, &browser, program, args),
        };
        if part == "recordings" {
            failed = failed.and(set_hour(workspace, &mut command));
        }
        // A part that fails does not prevent the others.
        failed = failed.and(process::run_with_lines(&mut command, |line| {
            rows.add_line(line);
        }));
    }
    rows.write_into(&workspace.root().join(TABLE), "bench")?;
    let files = site::files_of(&dist)?;
    for (name, bytes, max) in site::size_report(&dist)?.sums() {
        println!("{name}, gzip: {bytes} bytes (at most {max})");
    }
    println!("foreign hosts in the files: {}", list(&files));
    failed.map_err(refusal_of_flags)
}

/// Measures the computing time of one exchange.
fn pure_parts(workspace: &Workspace) -> Command {
    let args = "bench --quiet --package motorlink-bus --package motorlink --bench exchange --bench decimate";
    cargo::command(workspace, &args.split(' ').collect::<Vec<_>>())
}

/// Measures one part, and updates its rows.
fn alone(workspace: &Workspace, part: &mut Command) -> Result<()> {
    let mut rows = Rows::default();
    process::run_with_lines(part, |line| rows.add_line(line))?;
    rows.write_into(&workspace.root().join(TABLE), "bench")
}

/// Writes and reads a session file of one hour.
fn session(workspace: &Workspace) -> Command {
    example(workspace, "motorlink-session", "one_hour")
}

/// Drives virtual motors on a pseudo-terminal natively.
fn driver(workspace: &Workspace) -> Command {
    let built = workspace.target().join(PROFILE);
    let mut figures = example(workspace, "motorlink-command", "driver_figures");
    figures.env("MOTORLINK_COMMAND", motorlink(&built));
    figures
}

/// Runs the lines of another command for the same motor with ours and with that one.
fn compare_commands(workspace: &Workspace, rows: &mut Rows) -> Result<()> {
    let ours = motorlink(&workspace.target().join(PROFILE));
    let folder = workspace.target().join("other-command");
    other_command::compare(&ours, &folder, rows)
}

/// Runs an example of a crate, optimised.
fn example(workspace: &Workspace, package: &str, example: &str) -> Command {
    let mut cargo = cargo::command(workspace, &["run", "--quiet", "--profile", PROFILE]);
    cargo.args(["--package", package, "--example", example]);
    cargo
}

/// Writes the session file of one hour, and names it to a program of the bench.
fn set_hour(workspace: &Workspace, program: &mut Command) -> Result<()> {
    let hour = workspace.target().join("one-hour.mcap");
    let mut write = session(workspace);
    write.args(["--", "--write"]).arg(&hour);
    program.env("MOTORLINK_HOUR", hour);
    process::run(&mut write)
}

/// Runs full scans on faulty buses in virtual time, and prints how many found every motor.
fn full_scans(workspace: &Workspace) -> Command {
    let mut scans = example(workspace, "motorlink-bus", "full_scans");
    scans.args(["--", SCAN_SEEDS]);
    scans
}

/// Stops virtual motors in virtual time, and prints when they are braked.
fn stops(workspace: &Workspace) -> Command {
    example(workspace, "motorlink-bus", "stops")
}

/// Runs the fault simulation.
pub fn soak(workspace: &Workspace, args: &[String]) -> Result<()> {
    process::run(worlds(workspace).args(args)).map_err(refusal_of_flags)
}

/// The program of the fault simulation.
pub fn worlds(workspace: &Workspace) -> Command {
    let mut cargo = cargo::command(workspace, &[]);
    add_simulation(&mut cargo);
    cargo
}

/// Adds the arguments with which cargo runs the fault simulation; its own flags come next.
pub fn add_simulation(cargo: &mut Command) {
    cargo.args(["run", "--quiet", "--profile", PROFILE]);
    cargo.args(["--package", "motorlink-fault-simulation", "--"]);
}

/// Makes the README's moving picture and the screenshots, or the pictures of the command on a terminal.
pub fn screenshots(workspace: &Workspace, args: &[String]) -> Result<()> {
    if matches!(args, [what] if what == "terminal") {
        build_programs(workspace)?;
        let built = workspace.target().join(PROFILE);
        let mut pictures = example(workspace, "motorlink-command", "terminal_pictures");
        pictures.env("MOTORLINK_COMMAND", motorlink(&built));
        let folder = workspace.root().join("docs/terminal");
        return process::run(pictures.arg("--").arg(folder));
    }
    let (browser, _) = prepare(workspace)?;
    let mut program = program_of_bench(workspace, &browser, "screenshots", args);
    process::run(&mut program).map_err(refusal_of_flags)
}

/// Fails if the site is larger than allowed or names another host.
pub fn check_first_visit(dist: &Path) -> Result<()> {
    site::size_report(dist)?.check()?;
    let files = site::files_of(dist)?;
    if !other_hosts::named_in(&files).is_empty() {
        bail!("the site names other hosts: {}", list(&files));
    }
    Ok(())
}

fn list(files: &[crate::site_file::SiteFile]) -> String {
    let hosts: Vec<String> = other_hosts::named_in(files).into_iter().collect();
    if hosts.is_empty() {
        "none".to_owned()
    } else {
        hosts.join(", ")
    }
}

/// Builds everything; returns the browser and the site's directory.
pub fn prepare(workspace: &Workspace) -> Result<(Browser, PathBuf)> {
    ensure_linux()?;
    let browser = browser::ensure()?;
    let dist = site::build(workspace, Profile::Release)?;
    build_programs(workspace)?;
    Ok((browser, dist))
}

/// A program of `end-to-end`.
fn program_of_bench(
    workspace: &Workspace,
    browser: &Browser,
    program: &str,
    args: &[String],
) -> Command {
    let mut cargo = process::cargo();
    cargo.args(["run", "--quiet", "--package", "end-to-end"]);
    // The others are examples, which no test compiles; this one has tests of its own.
    let kind = if program == "wire" {
        "--bin"
    } else {
        "--example"
    };
    cargo.args([kind, program, "--"]).args(args);
    set_paths(&mut cargo, workspace, browser, Speed::QuickToRun);
    cargo
}

/// The bench shows Chromium a serial line through libudev, which only Linux has.
pub fn ensure_linux() -> Result<()> {
    if cfg!(target_os = "linux") {
        return Ok(());
    }
    bail!("the bench needs Linux: it shows its serial lines to Chromium through libudev")
}
