//! A name for the terminal that does not change from run to run.

use std::{
    fs,
    os::unix::fs::symlink,
    path::{Path, PathBuf},
};

use crate::failure::Failure;

/// A symbolic link that goes with the program.
#[derive(Debug)]
pub(crate) struct Link {
    path: PathBuf,
    target: PathBuf,
}

impl Link {
    /// # Errors
    /// Something exists at `path`, or it cannot be written.
    pub(crate) fn create(path: &Path, target: &Path) -> Result<Self, Failure> {
        symlink(target, path).map_err(|error| Failure::path("--link", path, &error))?;
        Ok(Self {
            path: path.to_owned(),
            target: target.to_owned(),
        })
    }
}

impl Drop for Link {
    /// Removes the link, unless it was replaced meanwhile.
    fn drop(&mut self) {
        if fs::read_link(&self.path).is_ok_and(|target| target == self.target) {
            // The program ends: no one reads an error, and a stale link does no harm.
            let _ = fs::remove_file(&self.path);
        }
    }
}
