//! The Python packages that read our files and check our figures, in fixed versions, installed once.

use std::{fs, path::PathBuf, process::Command};

use anyhow::{Context, Result, bail};

use crate::cargo;
use crate::npm;
use crate::process;
use crate::programs;
use crate::suite;
use crate::tools::cache_dir;
use crate::workspace::Workspace;

/// A virtual environment.
struct Environment {
    /// Another set of packages has another name.
    name: &'static str,
    packages: &'static [&'static str],
}

/// What reads our files and checks our figures.
const READERS: Environment = Environment {
    name: "readers-1",
    packages: &[
        // The reader of MCAP files with the decoder that ROS 2 users add, and a validator of JSON schemas.
        "mcap==1.6.0",
        "mcap-ros2-support==0.6.0",
        "jsonschema==4.26.0",
        // For CSV files, beside Python's own module.
        "pandas==2.3.3",
        // For the figures of experiments.
        "control==0.10.2",
        "numpy==2.2.6",
        "scipy==1.15.3",
    ],
};

/// For the Python package: what builds its wheel, and what its readings become. Nothing else, so that its tests fail if it
/// needs more.
const PACKAGE: Environment = Environment {
    name: "python-package-1",
    packages: &["maturin==1.16.0", "numpy==2.2.6"],
};

/// For messages of ROS 2.
const ROS_READERS: Environment = Environment {
    name: "ros-readers-1",
    packages: &["rosbags==0.11.9"],
};

const CSV_TESTS: &str = "recorder";

/// Lets the official readers, of Python and of Foxglove, read a session file, and validate it.
pub fn read_session(workspace: &Workspace) -> Result<()> {
    let foxglove = npm::MCAP_OF_FOXGLOVE.folder()?;
    let mut test = ignored_tests(workspace, "session")?;
    process::run(test.env("MOTORLINK_FOXGLOVE", foxglove))
}

/// Builds the wheel of the Python package, installs it into a folder of its own, and runs its tests.
pub fn test_package(workspace: &Workspace) -> Result<()> {
    let python = ensure(&PACKAGE)?;
    let root = workspace.root();
    let package = root.join("crates/python");
    let folder = root.join("target/python-package");
    // An earlier wheel is not installed instead.
    let _ = fs::remove_dir_all(&folder);
    // It delays no test that runs beside it.
    let mut build = process::without_our_package(suite::low_priority(&python, 10));
    build
        .args(["-m", "maturin", "build", "--quiet", "--profile", "dev"])
        .arg("--target-dir")
        .arg(root.join("target"))
        .arg("--manifest-path")
        .arg(package.join("Cargo.toml"))
        .arg("--out")
        .arg(&folder);
    process::run(&mut build)?;
    let wheel = fs::read_dir(&folder)?
        .next()
        .context("no wheel was built")??;
    let installed = folder.join("installed");
    let mut install = Command::new(&python);
    install
        .args(["-m", "pip", "install", "--quiet", "--no-index", "--no-deps"])
        .args(["--disable-pip-version-check", "--target"])
        .arg(&installed)
        .arg(wheel.path());
    process::run(&mut install)?;
    // The command comes with its tests: built alone, what it shares with others would be compiled once more.
    let command = ["--no-run", "--quiet", "--test", "command"];
    process::run(&mut cargo::native(workspace, "test", &command))?;
    let mut test = Command::new(&python);
    test.arg(package.join("tests/test_motorlink.py"))
        .env("PYTHONPATH", &installed)
        .env("MOTORLINK", root.join("target/debug/motorlink"));
    process::run(&mut test)
}

/// Lets Python's csv module and pandas read the CSV files that the page exports.
pub fn read_csv_files(workspace: &Workspace) -> Result<()> {
    let mut test = ignored_tests(workspace, CSV_TESTS)?;
    process::run(test.arg("python_and_pandas"))
}

/// Lets numpy, scipy and python-control compute the figures of known systems, and of the CSV files of runs.
pub fn compute_figures(workspace: &Workspace) -> Result<()> {
    let mut test = ignored_tests(workspace, "experiments")?;
    process::run(test.args(["independent_intervals::", "figures_in_python::"]))
}

/// Lets LibreOffice Calc open them.
pub fn open_csv_files(workspace: &Workspace) -> Result<()> {
    let libreoffice = programs::ensure(
        || programs::look_up("MOTORLINK_LIBREOFFICE", &["soffice", "libreoffice"]),
        // Without windows: 90 MB.
        &["libreoffice-calc-nogui"],
        "LibreOffice is missing: install it (Debian: apt-get install libreoffice-calc-nogui) or name \
         its program soffice in MOTORLINK_LIBREOFFICE",
    )?;
    let mut test = ignored_tests(workspace, CSV_TESTS)?;
    test.arg("libreoffice");
    process::run(test.env("MOTORLINK_LIBREOFFICE", libreoffice))
}

/// A Python that reads messages of ROS 2.
pub fn with_rosbags() -> Result<PathBuf> {
    ensure(&ROS_READERS)
}

/// The tests of a program that need Python.
fn ignored_tests(workspace: &Workspace, program: &str) -> Result<Command> {
    let python = ensure(&READERS)?;
    let mut command = cargo::native(workspace, "test", &["--quiet", "--test", program]);
    command
        .args(["--", "--ignored"])
        .env("MOTORLINK_PYTHON", python)
        // With it, each of many programs would compile scipy again.
        .env_remove("PYTHONDONTWRITEBYTECODE");
    Ok(command)
}

/// The Python of this environment; makes it if it is missing.
fn ensure(Environment { name, packages }: &Environment) -> Result<PathBuf> {
    let tools = cache_dir()?.join("tools");
    let dir = tools.join(name);
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
            "python3 is missing: install Python 3.10 or newer (Debian: apt-get install python3-venv)"
        );
    }
    println!(
        "installing {} into {} (once)",
        packages.join(", "),
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
        // Python compiles what it imports, which is little of it.
        "--no-compile",
    ]);
    process::run(pip.args(*packages))?;
    fs::write(&complete, packages.join("\n")).with_context(|| format!("{}", complete.display()))?;
    Ok(dir.join(program))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// Otherwise cargo compiles the bus, the driver and the command once more for the wheel: minutes of each test run.
    #[test]
    fn the_wheel_has_the_features_of_the_workspace() {
        let workspace = Workspace::find().unwrap();
        let compiled = |of: &[&str], edges: &str| -> BTreeSet<String> {
            let form = ["--prefix", "none", "--format", "{p} {f}"];
            let args = [&["tree", "--edges", edges], &form[..], of].concat();
            let listed = process::output(&mut cargo::command(&workspace, &args)).unwrap();
            let names = listed
                .lines()
                .map(|line| line.trim_end_matches(" (*)").trim());
            names.map(str::to_owned).collect()
        };
        let all = ["--workspace", "--exclude", "motorlink-worker"];
        let all = compiled(&all, "normal,build,dev");
        let wheel = compiled(&["--package", "motorlink-python"], "normal,build");
        let other: Vec<&String> = wheel.difference(&all).collect();
        assert!(other.is_empty(), "compiled once more: {other:?}");
    }
}
