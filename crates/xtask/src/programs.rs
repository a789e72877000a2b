//! Programs of the system: found on the PATH, or installed with its package manager.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, bail};

use crate::failure::BadInput;
use crate::process;

/// A program named by a variable, else the first of some names on the PATH.
pub fn look_up(variable: &str, names: &[&str]) -> Result<Option<PathBuf>> {
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

/// Finds programs, or installs their packages with the system's package manager if that is allowed. `missing` says what
/// to do otherwise.
pub fn ensure<T>(
    find: impl Fn() -> Result<Option<T>>,
    packages: &[&str],
    missing: &str,
) -> Result<T> {
    if let Some(found) = find()? {
        return Ok(found);
    }
    if install(packages)?
        && let Some(found) = find()?
    {
        return Ok(found);
    }
    bail!("{missing}")
}

/// Installs packages of Debian, if that is allowed. Returns whether it did.
fn install(packages: &[&str]) -> Result<bool> {
    if !may_install() {
        return Ok(false);
    }
    println!("installing {}", packages.join(" and "));
    let apt = |args: &[&str]| {
        let mut command = Command::new("apt-get");
        command.env("DEBIAN_FRONTEND", "noninteractive").args(args);
        process::run(&mut command)
    };
    apt(&["-q", "update"])?;
    let install = ["-q", "install", "--yes", "--no-install-recommends"];
    apt(&[&install[..], packages].concat())?;
    Ok(true)
}

/// Only root can install. The program never asks for a password: a test may run unattended.
fn may_install() -> bool {
    let root = process::output_of("id", &["-u"]).is_some_and(|id| id.trim() == "0");
    root && Path::new("/usr/bin/apt-get").is_file()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHROMIUM_NAMES: [&str; 2] = ["chromium", "google-chrome"];

    #[test]
    fn names_go_before_directories() {
        let base = env::temp_dir().join(format!("xtask-programs-{}", std::process::id()));
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
        assert_eq!(first_on(&dirs, &["chromedriver"]), None);
        std::fs::remove_dir_all(base).unwrap();
    }
}
