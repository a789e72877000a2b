//! The stories: what a person does, played in a real browser over real Web Serial.

use std::ffi::OsStr;
use std::fs;
use std::process::Command;

use anyhow::{Context, Result};

use crate::bench;
use crate::browser;
use crate::npm;
use crate::process;
use crate::workspace::Workspace;

const PACKAGE: [&str; 2] = ["--package", "end-to-end"];

/// These judge no times: another browser may be busy beside theirs.
const UNTIMED: [&str; 3] = ["accessibility", "security", "setup"];

/// Compiles them, for whoever has a core to spare before they are played.
pub fn compiling(workspace: &Workspace) -> Command {
    let mut cargo = process::cargo();
    cargo.current_dir(workspace.root());
    cargo.args(["test", "--no-run"]).args(PACKAGE);
    cargo
}

/// Plays every story, and tests what they are played with.
pub fn play(workspace: &Workspace) -> Result<()> {
    bench::ensure_linux()?;
    let browser = browser::ensure()?;
    let axe = npm::AXE.ensure()?;
    let test = |what: &[&str], files: &[&str], at_once: &str| {
        let mut cargo = process::cargo();
        bench::equip(&mut cargo, workspace, &browser);
        cargo.env("MOTORLINK_AXE", &axe);
        cargo.arg("test").args(PACKAGE).args(what);
        cargo.args(files.iter().flat_map(|file| ["--test", *file]));
        cargo.args(["--", "--test-threads", at_once]);
        process::run(&mut cargo)
    };
    test(&["--doc"], &[], "1")?;
    test(&["--lib", "--bins"], &UNTIMED, "2")?;
    let files = files(workspace)?;
    let timed: Vec<&str> = timed(&files).collect();
    // Each judges times on the wire, and two browsers would disturb each other.
    test(&[], &timed, "1")
}

/// What is not named above judges times.
fn timed(files: &[String]) -> impl Iterator<Item = &str> {
    let files = files.iter().map(String::as_str);
    files.filter(|file| !UNTIMED.contains(file))
}

/// The names of all files of stories, in order.
fn files(workspace: &Workspace) -> Result<Vec<String>> {
    let dir = workspace.root().join("tests/end-to-end/tests");
    let mut files = Vec::new();
    let entries = fs::read_dir(&dir).with_context(|| format!("reading {}", dir.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.extension() == Some(OsStr::new("rs")) {
            let name = path.file_stem().context("a file without a name")?;
            files.push(name.to_string_lossy().into_owned());
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_story_is_played_once() {
        let files = files(&Workspace::find().unwrap()).unwrap();
        let named = |name: &str| files.iter().any(|file| file == name);
        assert!(UNTIMED.iter().all(|name| named(name)));
        assert_eq!(timed(&files).count() + UNTIMED.len(), files.len());
    }
}
