//! Which program holds a port.

use std::fmt;

/// A program that has a port open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// Its name, as `ps` shows it.
    pub name: String,
    /// Its process number.
    pub process: u32,
    /// Whether it is suspended, as by `kill -STOP`: it stops no motor.
    pub is_suspended: bool,
}

impl Holder {
    /// What to do about it, where that is known.
    #[must_use]
    pub fn remedy(&self) -> &'static str {
        match self.name.as_str() {
            _ if self.is_suspended => {
                "it is suspended, and its wheels may turn: kill it with kill -9, then motorlink stop"
            }
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
        let read = |file| fs::read_to_string(entry.path().join(file)).unwrap_or_default();
        return Some(Holder {
            name: read("comm").trim().to_owned(),
            process,
            is_suspended: is_suspended(&read("stat")),
        });
    }
    None
}

/// Whether `/proc/N/stat` says so. The state is behind the name, which may have any characters.
#[cfg(target_os = "linux")]
fn is_suspended(stat: &str) -> bool {
    let rest = stat.rsplit_once(") ");
    rest.is_some_and(|(_, rest)| rest.starts_with(['T', 't']))
}

/// Other systems do not tell.
#[cfg(not(target_os = "linux"))]
pub(crate) fn holder_of(_path: &str) -> Option<Holder> {
    None
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn a_suspended_program_is_told_from_one_that_runs() {
        assert!(is_suspended("71 (motor) S link) T 1 71 71"));
        assert!(!is_suspended("71 (motor) T link) S 1 71 71"));
        assert!(!is_suspended(""));
        let holder = |is_suspended| Holder {
            name: "motorlink".to_owned(),
            process: 71,
            is_suspended,
        };
        assert!(holder(true).remedy().contains("kill -9"));
        assert_eq!(holder(false).remedy(), "end it first");
    }
}
