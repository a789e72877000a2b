//! Finds the artefacts that must be built before the bench can run.

use std::cmp::Reverse;
use std::path::{Path, PathBuf};
use std::{env, fs};

use anyhow::{Result, bail};

/// The preloaded library: `MOTORLINK_UDEV_SHIM`, or in the workspace's target directory.
///
/// # Errors
///
/// When it is in neither place.
pub fn udev_shim() -> Result<PathBuf> {
    find(
        "MOTORLINK_UDEV_SHIM",
        &in_target("libudev_shim.so"),
        "cargo build -p udev-shim",
    )
}

/// The command with the motors at the far end of the wire: `MOTORLINK_COMMAND`, or in the workspace's target directory.
///
/// # Errors
///
/// When it is in neither place.
pub fn command() -> Result<PathBuf> {
    find(
        "MOTORLINK_COMMAND",
        &in_target("motorlink"),
        "cargo build -p motorlink-command",
    )
}

/// The built page: `MOTORLINK_DIST`, or the workspace's `dist`.
///
/// # Errors
///
/// When it is in neither place.
pub fn dist() -> Result<PathBuf> {
    find(
        "MOTORLINK_DIST",
        &[workspace().join("dist")],
        "cargo xtask build",
    )
}

/// The checker of accessibility: `MOTORLINK_AXE`.
///
/// # Errors
///
/// When it is not there.
pub fn axe() -> Result<PathBuf> {
    find(
        "MOTORLINK_AXE",
        &[PathBuf::from("axe.min.js")],
        "cargo xtask test --only end-to-end",
    )
}

/// The browser: `MOTORLINK_CHROMIUM`, or the first Chromium in the path.
///
/// # Errors
///
/// When there is none.
pub fn chromium() -> Result<PathBuf> {
    let path = env::var_os("PATH").unwrap_or_default();
    let dirs: Vec<PathBuf> = env::split_paths(&path).collect();
    let names = [
        "chromium",
        "chromium-browser",
        "google-chrome",
        "google-chrome-stable",
    ];
    let candidates: Vec<PathBuf> = names
        .iter()
        .flat_map(|name| dirs.iter().map(move |dir| dir.join(name)))
        .collect();
    find(
        "MOTORLINK_CHROMIUM",
        &candidates,
        "apt-get install chromium",
    )
}

/// Copies a site with all its folders, for a scenario that changes a part of it.
///
/// # Errors
///
/// When it cannot be read or written.
pub fn copy_site(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let to = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_site(&entry.path(), &to)?;
        } else {
            fs::copy(entry.path(), to)?;
        }
    }
    Ok(())
}

fn find(variable: &str, candidates: &[PathBuf], command: &str) -> Result<PathBuf> {
    let named = env::var_os(variable).map(|path| vec![PathBuf::from(path)]);
    let candidates = named.as_deref().unwrap_or(candidates);
    let Some(found) = candidates.iter().find(|path| path.exists()) else {
        let first = candidates
            .first()
            .map_or("anywhere".into(), |path| path.to_string_lossy());
        bail!("not found: {first}. Run `{command}`, or set {variable} to where it is");
    };
    // The path must be absolute: the loader of a process with another working directory uses it.
    Ok(std::path::absolute(found)?)
}

/// The places in which cargo may have put a file. The newest is first, because the last build is meant.
fn in_target(file: &str) -> Vec<PathBuf> {
    let target = env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| workspace().join("target"), |dir| workspace().join(dir));
    let mut files: Vec<PathBuf> = ["debug", "release", "bench-native"]
        .map(|profile| target.join(profile).join(file))
        .into();
    files.sort_by_key(|file| Reverse(file.metadata().and_then(|found| found.modified()).ok()));
    files
}

fn workspace() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}
