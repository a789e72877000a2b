//! `cargo xtask test`: the tests, from the native ones to the page in a real browser.

use std::process::Command;

use anyhow::Result;

use crate::bench;
use crate::cargo;
use crate::npm;
use crate::page_tests;
use crate::process;
use crate::python;
use crate::ros;
use crate::scenarios;
use crate::site;
use crate::site_file::Profile;
use crate::suite::{self, Step, Suite};
use crate::workspace::Workspace;

/// Every step, in order.
pub static SUITE: Suite = Suite {
    name: "test",
    steps: &[
        Step {
            name: "build",
            about: "the tests compile; the released site builds, is light enough and names no other host",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: false,
            run: build,
        },
        Step {
            name: "wasm",
            about: "tests of page and worker in a real browser",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: false,
            run: page_tests::run,
        },
        Step {
            name: "end-to-end",
            about: "scenarios: the page in a real browser drives motors over real Web Serial",
            needs: &["build"],
            beside: None,
            nice: 0,
            on_request: false,
            run: scenarios::run_side_by_side,
        },
        Step {
            name: "session-readers",
            about: "the readers of Python and of Foxglove read a session file, and each message fits its schema",
            needs: &[],
            beside: Some("end-to-end"),
            nice: 19,
            on_request: false,
            run: python::read_session,
        },
        Step {
            name: "foxglove-client",
            about: "the client of Foxglove watches a server, and each message fits its schema",
            needs: &[],
            beside: Some("end-to-end"),
            nice: 10,
            on_request: false,
            run: watch_by_foxglove,
        },
        Step {
            name: "csv-readers",
            about: "Python's csv module and pandas read the exported CSV files",
            needs: &[],
            beside: Some("end-to-end"),
            nice: 19,
            on_request: false,
            run: python::read_csv_files,
        },
        Step {
            name: "figures-in-python",
            about: "Python computes the figures of known systems, and those of experiments from the exported CSV files",
            needs: &[],
            beside: Some("end-to-end"),
            nice: 19,
            on_request: false,
            run: python::compute_figures,
        },
        Step {
            name: "python-package",
            about: "the Python package: its wheel, its tests on virtual motors, and its examples",
            needs: &[],
            // It waits for virtual motors more than it computes.
            beside: Some("wasm"),
            nice: 0,
            on_request: false,
            run: python::test_package,
        },
        Step {
            name: "native-in-real-time",
            about: "tests of the command and of its server, which wait for motors more than they compute",
            needs: &[],
            // Behind the Python package: two at once delay each other's motors.
            beside: Some("wasm"),
            nice: 0,
            on_request: false,
            run: |workspace| {
                process::run(&mut native_tests(workspace, |name| {
                    IN_REAL_TIME.contains(&name)
                }))
            },
        },
        Step {
            name: "csv-in-libreoffice",
            about: "LibreOffice opens the exported CSV files",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: true,
            run: python::open_csv_files,
        },
        Step {
            name: "ros",
            about: "the topics of ROS 2: lints and tests of crates/ros, with Zenoh, hiroz and rosbags",
            needs: &[],
            beside: None,
            nice: 0,
            on_request: true,
            run: ros::test,
        },
        Step {
            name: "native",
            about: "tests of the native code, of the page's pure parts, and of the examples in the documentation",
            needs: &[],
            beside: Some("end-to-end"),
            nice: 19,
            on_request: false,
            run: |workspace| {
                // It computes, on the processor time that the browser leaves.
                let mut tests = native_tests(workspace, |name| {
                    name != scenarios::PROGRAM && !IN_REAL_TIME.contains(&name)
                });
                add_units(workspace, &mut tests);
                process::run(&mut suite::idle(&tests))?;
                let examples = cargo::native(workspace, "test", &["--quiet", "--doc"]);
                process::run(&mut suite::idle(&examples))
            },
        },
        Step {
            name: "checks",
            about: "`cargo xtask check`, on the processor time that the browser leaves",
            needs: &[],
            // With the step beside which that one runs, it leaves the most.
            beside: Some("native-in-real-time"),
            nice: 10,
            on_request: true,
            run: |_| {
                // The tests beside it are built, so that cargo can use the folder in which it builds.
                process::run(suite::idle_program()?.arg("check"))
            },
        },
        Step {
            name: "end-to-end-alone",
            about: "scenarios that a busy computer would fail, with no other program beside them",
            needs: &["build"],
            beside: None,
            nice: 0,
            on_request: false,
            run: scenarios::run_alone,
        },
    ],
};

/// Programs of tests in which motors turn in real time.
const IN_REAL_TIME: [&str; 4] = ["attempts", "command", "control_socket", "foxglove"];

/// The tests of these programs.
fn native_tests(workspace: &Workspace, is_meant: fn(&str) -> bool) -> Command {
    let mut test = cargo::native(workspace, "test", &["--quiet"]);
    let names = workspace.test_programs().iter();
    for name in names.filter(|name| is_meant(name)) {
        test.args(["--test", name]);
    }
    test
}

/// Adds the tests in the files of libraries and programs. With `--bins`, cargo would build the page's program, which has
/// none, and for it the page once more.
fn add_units(workspace: &Workspace, tests: &mut Command) {
    tests.arg("--lib");
    for name in workspace.tested_programs() {
        tests.args(["--bin", name]);
    }
}

/// Linking the site keeps one core busy for minutes: the tests compile beside it.
fn build(workspace: &Workspace) -> Result<()> {
    // Clippy sees the examples.
    let mut tests = native_tests(workspace, |_| true);
    add_units(workspace, tests.arg("--no-run"));
    let dist = process::run_while(&mut tests, || site::build(workspace, Profile::Release))?;
    bench::check_first_visit(&dist)?;
    // The tests have built the virtual motor. This is the library that shows Chromium its serial line; any other package
    // with it would be compiled once more, without the features that only tests need.
    let shim = ["build", "--package", "udev-shim"];
    process::run(&mut cargo::command(workspace, &shim))?;
    scenarios::note_program(workspace)
}

/// Lets the client of Foxglove watch a server with a virtual motor.
fn watch_by_foxglove(workspace: &Workspace) -> Result<()> {
    let client = npm::FOXGLOVE_CLIENT.folder()?;
    let mut test = cargo::native(workspace, "test", &["--quiet", "--test", "foxglove"]);
    test.args(["--", "--ignored"])
        .env("MOTORLINK_FOXGLOVE_CLIENT", client);
    process::run(&mut test)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};

    use super::*;

    #[test]
    fn a_program_that_runs_beside_others_exists() {
        let workspace = Workspace::find().unwrap();
        let programs = workspace.test_programs();
        for name in IN_REAL_TIME.into_iter().chain([scenarios::PROGRAM]) {
            let found = programs.iter().filter(|program| *program == name);
            assert_eq!(found.count(), 1, "{name}");
        }
    }

    /// Cargo would leave them out without a word.
    #[test]
    fn a_library_without_tests_of_its_own_has_none() {
        let crates = Workspace::find().unwrap().root().join("crates");
        let mut libraries = 0;
        for found in fs::read_dir(crates).unwrap() {
            let dir = found.unwrap().path();
            let manifest = fs::read_to_string(dir.join("Cargo.toml")).unwrap();
            if manifest.contains("test = false") {
                libraries += 1;
                for file in rust_files(&dir.join("src")) {
                    let source = fs::read_to_string(&file).unwrap();
                    assert!(!source.contains("#[test]"), "{}", file.display());
                }
            }
        }
        assert!(libraries > 0);
    }

    /// There the library is empty: see the top of `src/lib.rs`.
    #[test]
    fn no_test_in_the_files_of_the_page_needs_a_browser() {
        let files = rust_files(&Workspace::find().unwrap().root().join("src"));
        assert!(files.len() > 100);
        for file in files {
            let source = fs::read_to_string(&file).unwrap();
            assert!(
                !source.contains("#[wasm_bindgen_test"),
                "{}",
                file.display()
            );
        }
    }

    fn rust_files(dir: &Path) -> Vec<PathBuf> {
        let entries = fs::read_dir(dir).unwrap();
        entries
            .map(|entry| entry.unwrap().path())
            .flat_map(|path| match path.extension() {
                None => rust_files(&path),
                Some(_) => vec![path],
            })
            .collect()
    }

    /// Such a crate names its files of tests in one place, so that they are one program. Cargo does not notice a file
    /// that is not named there.
    #[test]
    fn a_program_of_tests_has_every_file_beside_it() {
        let crates = Workspace::find().unwrap().root().join("crates");
        let mut programs = 0;
        for found in fs::read_dir(crates).unwrap() {
            let dir = found.unwrap().path().join("tests");
            let Ok(main) = fs::read_to_string(dir.join("main.rs")) else {
                continue;
            };
            programs += 1;
            for file in fs::read_dir(&dir).unwrap() {
                let path = file.unwrap().path();
                let name = path.file_stem().unwrap().to_string_lossy();
                let is_test = path.extension().is_some_and(|ending| ending == "rs");
                let is_named = name == "main" || main.contains(&format!("mod {name};"));
                assert!(is_named || !is_test, "{} is not in main.rs", path.display());
            }
        }
        assert!(programs > 0);
    }
}
