//! Which program holds a port.

use std::fmt;

/// A program that has a port open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// Its name, as `ps` shows it.
    pub name: String,
    /// Its process number.
    pub process: u32,
}

impl Holder {
    /// What to do about it, where that is known.
    #[must_use]
    pub fn remedy(&self) -> &'static str {
        match self.name.as_str() {
            "ModemManager" => "sudo systemctl stop ModemManager",
            "brltty" => "sudo apt remove brltty, then plug the adapter in again",
            "motorlink" => "end it first",
            _ => "close it, then try again",
        }
    }
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (process {})", self.name, self.process)
    }
}

/// The other program that has this port open, if this process may see it.
#[cfg(target_os = "linux")]
pub(crate) fn holder_of(path: &str) -> Option<Holder> {
    use std::{fs, path::Path};

    let port = fs::canonicalize(path).ok()?;
    // A pseudo-terminal is open in the program that makes it.
    if port.starts_with("/dev/pts") {
        return None;
    }
    let own = std::process::id();
    let has_open = |process: &Path| {
        let files = fs::read_dir(process.join("fd")).into_iter().flatten();
        let mut targets = files.flatten().flat_map(|file| fs::read_link(file.path()));
        targets.any(|target| target == port)
    };
    for entry in fs::read_dir("/proc").ok()?.flatten() {
        let Some(process) = entry
            .file_name()
            .to_str()
            .and_then(|name| name.parse().ok())
        else {
            continue;
        };
        if process == own || !has_open(&entry.path()) {
            continue;
        }
        let name = fs::read_to_string(entry.path().join("comm")).unwrap_or_default();
        let name = name.trim().to_owned();
        return Some(Holder { name, process });
    }
    None
}

/// Other systems do not tell.
#[cfg(not(target_os = "linux"))]
pub(crate) fn holder_of(_path: &str) -> Option<Holder> {
    None
}
