//! Chromium and chromedriver, for the browser tests and the bench.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};

use crate::failure::BadInput;
use crate::process;

/// Names under which systems install Chromium.
const CHROMIUM_NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// Names under which systems install its driver.
const DRIVER_NAMES: [&str; 1] = ["chromedriver"];

/// The browser and the program through which tests drive it.
#[derive(Debug)]
pub struct Browser {
    /// Chromium.
    pub chromium: PathBuf,
    /// chromedriver.
    pub driver: PathBuf,
}

/// Finds both, or installs them with the system's package manager if that is allowed.
pub fn ensure() -> Result<Browser> {
    if let Some(browser) = find()? {
        return Ok(browser);
    }
    if may_install() {
        install()?;
        if let Some(browser) = find()? {
            return Ok(browser);
        }
    }
    bail!(
        "Chromium or chromedriver is missing: install both (Debian: apt-get install chromium \
         chromium-driver) or name them in MOTORLINK_CHROMIUM and CHROMEDRIVER"
    )
}

fn find() -> Result<Option<Browser>> {
    let chromium = look_up("MOTORLINK_CHROMIUM", &CHROMIUM_NAMES)?;
    let driver = look_up("CHROMEDRIVER", &DRIVER_NAMES)?;
    Ok(chromium
        .zip(driver)
        .map(|(chromium, driver)| Browser { chromium, driver }))
}

/// A program named by a variable, else the first of some names on the PATH.
fn look_up(variable: &str, names: &[&str]) -> Result<Option<PathBuf>> {
    if let Some(named) = env::var_os(variable).filter(|named| !named.is_empty()) {
        let path = PathBuf::from(named);
        if path.is_file() {
            return Ok(Some(path));
        }
        // Another one than the named one would hide the mistake.
        let text = format!("{variable} names {}, which is no file", path.display());
        return Err(BadInput(text).into());
    }
    let dirs: Vec<PathBuf> = env::var_os("PATH")
        .map(|path| env::split_paths(&path).collect())
        .unwrap_or_default();
    Ok(first_on(&dirs, names))
}

fn first_on(dirs: &[PathBuf], names: &[&str]) -> Option<PathBuf> {
    names.iter().find_map(|name| {
        dirs.iter()
            .map(|dir| dir.join(format!("{name}{}", env::consts::EXE_SUFFIX)))
            .find(|path| path.is_file())
    })
}

/// Only root can install. The program never asks for a password: a test may run unattended.
fn may_install() -> bool {
    let root = process::output_of("id", &["-u"]).is_some_and(|id| id.trim() == "0");
    root && Path::new("/usr/bin/apt-get").is_file()
}

fn install() -> Result<()> {
    println!("installing chromium and chromium-driver");
    let apt = |args: &[&str]| {
        let mut command = Command::new("apt-get");
        command.env("DEBIAN_FRONTEND", "noninteractive").args(args);
        process::run(&mut command)
    };
    apt(&["-q", "update"])?;
    apt(&[
        "-q",
        "install",
        "--yes",
        "--no-install-recommends",
        "chromium",
        "chromium-driver",
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_before_directories() {
        let base = env::temp_dir().join(format!("xtask-browser-{}", std::process::id()));
        let dirs = [base.join("a"), base.join("b")];
        let program = |name: &str| format!("{name}{}", env::consts::EXE_SUFFIX);
        for dir in &dirs {
            std::fs::create_dir_all(dir).unwrap();
        }
        let (chrome, chromium) = (program("google-chrome"), program("chromium"));
        std::fs::write(dirs[0].join(&chrome), "").unwrap();
        std::fs::write(dirs[1].join(&chromium), "").unwrap();
        assert_eq!(
            first_on(&dirs, &CHROMIUM_NAMES),
            Some(dirs[1].join(&chromium))
        );
        assert_eq!(
            first_on(&dirs[..1], &CHROMIUM_NAMES),
            Some(dirs[0].join(&chrome))
        );
        assert_eq!(first_on(&dirs, &DRIVER_NAMES), None);
        std::fs::remove_dir_all(base).unwrap();
    }
}
