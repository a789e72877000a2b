//! The bench: virtual motors on a serial line, a real Chromium in front, and what is measured there.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};

use crate::browser::{self, Browser};
use crate::failure::refusal_of_flags;
use crate::foreign;
use crate::process;
use crate::site::{self, Profile};
use crate::size;
use crate::tables::Rows;
use crate::workspace::Workspace;

/// Of measurements: these programs stand for a motor, which answers after 0.6 ms.
const PROFILE: &str = "bench-native";

/// How the programs of the bench are built.
#[derive(Clone, Copy, Debug)]
pub enum Speed {
    /// With the tests, whose dependencies they share; the motor itself is optimised there, too.
    QuickToBuild,
    /// Optimised as a whole, for measurements.
    QuickToRun,
}

impl Speed {
    /// Cargo's directory for what it builds so.
    fn target_dir(self) -> &'static str {
        match self {
            Self::QuickToBuild => "debug",
            Self::QuickToRun => PROFILE,
        }
    }
}

/// Lines on which full scans are played; one run in a thousand may miss a motor.
const SCAN_SEEDS: &str = "1000";

/// Builds the virtual motor and the library that shows Chromium its serial line.
pub fn build_programs(workspace: &Workspace) -> Result<()> {
    let mut cargo = process::cargo();
    cargo.current_dir(workspace.root());
    cargo.args(["build", "--profile", PROFILE]);
    cargo.args(["--package", "virtual-motor", "--package", "udev-shim"]);
    process::run(&mut cargo)
}

/// Tells a program of the package `end-to-end` where everything is.
pub fn equip(command: &mut Command, workspace: &Workspace, browser: &Browser, speed: Speed) {
    let built = workspace.target().join(speed.target_dir());
    command
        .current_dir(workspace.root())
        .env("MOTORLINK_UDEV_SHIM", udev_shim(&built))
        .env("MOTORLINK_VIRTUAL_MOTOR", virtual_motor(&built))
        .env("MOTORLINK_DIST", workspace.dist())
        .env("MOTORLINK_CHROMIUM", &browser.chromium)
        .env("CHROMEDRIVER", &browser.driver);
}

fn virtual_motor(built: &Path) -> PathBuf {
    built.join(format!("virtual-motor{}", std::env::consts::EXE_SUFFIX))
}

fn udev_shim(built: &Path) -> PathBuf {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    built.join(format!("{DLL_PREFIX}udev_shim{DLL_SUFFIX}"))
}

/// What can be measured by itself: programs of `end-to-end`, and what needs no browser.
const PARTS: [&str; 6] = ["start", "figures", "instruments", "wire", "scans", "pure"];

/// Measures the figures that the page is held to, prints them, and puts them into the README's table.
///
/// The first of `args` may name a part; what is not measured keeps its rows.
pub fn figures(workspace: &Workspace, args: &[String]) -> Result<()> {
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
        let mut command = match part {
            "scans" => full_scans(workspace),
            "pure" => pure_parts(workspace),
            program => program_of_bench(workspace, &browser, program, args),
        };
        // What one of them cannot measure keeps none of the others from it.
        failed = failed.and(process::run_and_hear(&mut command, |line| rows.hear(line)));
    }
    rows.write_into(&workspace.root().join("README.md"), "bench")?;
    let files = site::files_of(&dist)?;
    let bytes = size::Report::new(&files)?.first_visit_gzip_bytes();
    let max = size::FIRST_VISIT_GZIP_BYTES_MAX;
    println!("first visit, gzip: {bytes} bytes (at most {max})");
    println!("foreign hosts in the files: {}", list(&files));
    failed.map_err(refusal_of_flags)
}

/// Measures what one exchange costs in computing.
fn pure_parts(workspace: &Workspace) -> Command {
    let mut cargo = process::cargo();
    cargo.current_dir(workspace.root());
    cargo.args(["bench", "--quiet", "--package", "motorlink-bus"]);
    cargo.args([
        "--package",
        "motorlink",
        "--bench",
        "exchange",
        "--bench",
        "decimate",
    ]);
    cargo
}

/// Plays full scans on bad lines in virtual time, and prints how many runs found every motor.
fn full_scans(workspace: &Workspace) -> Command {
    let mut cargo = process::cargo();
    cargo.current_dir(workspace.root());
    cargo.args(["run", "--quiet", "--profile", PROFILE]);
    cargo.args(["--package", "motorlink-bus", "--example", "full_scans"]);
    cargo.args(["--", SCAN_SEEDS]);
    cargo
}

/// Plays worlds that fail.
pub fn soak(workspace: &Workspace, args: &[String]) -> Result<()> {
    process::run(worlds(workspace).args(args)).map_err(refusal_of_flags)
}

/// The program that plays them.
pub fn worlds(workspace: &Workspace) -> Command {
    let mut cargo = process::cargo();
    cargo.current_dir(workspace.root());
    name_worlds(&mut cargo);
    cargo
}

/// Lets cargo run the program that plays worlds; its flags come next.
pub fn name_worlds(cargo: &mut Command) {
    cargo.args(["run", "--quiet", "--profile", PROFILE]);
    cargo.args(["--package", "motorlink-fault-simulation", "--"]);
}

/// Makes the README's moving picture and the screenshots.
pub fn screenshots(workspace: &Workspace, args: &[String]) -> Result<()> {
    let (browser, _) = prepare(workspace)?;
    let mut program = program_of_bench(workspace, &browser, "screenshots", args);
    process::run(&mut program).map_err(refusal_of_flags)
}

/// Fails where the site is heavier than it may be or names another host.
pub fn check_first_visit(dist: &Path) -> Result<()> {
    let files = site::files_of(dist)?;
    let bytes = size::Report::new(&files)?.first_visit_gzip_bytes();
    let max = size::FIRST_VISIT_GZIP_BYTES_MAX;
    if bytes > max {
        bail!(
            "a first visit costs {bytes} bytes, {} more than it may",
            bytes - max
        );
    }
    if !foreign::hosts(&files).is_empty() {
        bail!("the site names other hosts: {}", list(&files));
    }
    Ok(())
}

fn list(files: &[site::SiteFile]) -> String {
    let hosts: Vec<String> = foreign::hosts(files).into_iter().collect();
    if hosts.is_empty() {
        "none".to_owned()
    } else {
        hosts.join(", ")
    }
}

/// Builds everything; gives the browser and the site's directory.
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
    cargo.args(["--bin", program, "--"]).args(args);
    equip(&mut cargo, workspace, browser, Speed::QuickToRun);
    cargo
}

/// The bench shows Chromium a serial line through libudev, which only Linux has.
pub fn ensure_linux() -> Result<()> {
    if cfg!(target_os = "linux") {
        return Ok(());
    }
    bail!("the bench needs Linux: it shows its serial lines to Chromium through libudev")
}
