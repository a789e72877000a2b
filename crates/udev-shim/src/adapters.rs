//! The adapters there are: a directory with one file each.

use std::collections::BTreeMap;
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Names the directory of adapters.
const DIR_VARIABLE: &str = "MOTORLINK_UDEV_DIR";

/// A file of properties is some 150 bytes; whatever is far longer is no adapter.
const FILE_BYTES_MAX: u64 = 4096;

/// Where a device stands in sysfs, as far as Chromium is told. It must not start with
/// `/sys/devices/platform/`: such a port is taken for one soldered to the board.
const SYSPATH_PREFIX: &str = "/sys/devices/motorlink/";

/// The subsystem of every adapter.
pub const SUBSYSTEM: &str = "tty";

/// One adapter as udev would describe it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adapter {
    /// Its file's name, which is its identity from plug to pull.
    pub name: String,
    /// Its udev properties, those of its file and those that every adapter has.
    pub properties: BTreeMap<CString, CString>,
}

impl Adapter {
    /// The adapter that a file of this name and text describes; none if the name is hidden or no
    /// device node is given.
    pub fn parse(name: &str, text: &str) -> Option<Self> {
        let mut adapter = Self::unplugged(name)?;
        // Chromium shows a tty only if its major and minor belong to a driver of type `serial` in
        // /proc/tty/drivers; 4:64 is /dev/ttyS0, which every PC has. Nothing opens it by number.
        let common = [("ID_BUS", "usb"), ("MAJOR", "4"), ("MINOR", "64")];
        let own = text.lines().filter_map(|line| line.trim().split_once('='));
        for (key, value) in common.into_iter().chain(own) {
            if let (Ok(key), Ok(value)) = (CString::new(key), CString::new(value)) {
                adapter.properties.insert(key, value);
            }
        }
        adapter
            .properties
            .contains_key(c"DEVNAME")
            .then_some(adapter)
    }

    /// An adapter of which only the name is left, its file being gone; none if the name is hidden.
    pub fn unplugged(name: &str) -> Option<Self> {
        let visible = !name.is_empty() && !name.starts_with('.') && !name.contains('/');
        visible.then(|| Self {
            name: name.to_owned(),
            properties: BTreeMap::new(),
        })
    }

    /// The path by which the device is known: unique, and equal at plug and pull.
    pub fn syspath(&self) -> String {
        format!("{SYSPATH_PREFIX}{}", self.name)
    }
}

/// The directory of adapters, if one is named.
pub fn directory() -> Option<PathBuf> {
    env::var_os(DIR_VARIABLE).map(PathBuf::from)
}

/// The adapter in the file of this name, if it is there and describes one.
pub fn read(dir: &Path, name: &str) -> Option<Adapter> {
    Adapter::unplugged(name)?;
    let path = dir.join(name);
    let found = fs::metadata(&path).ok()?;
    if !found.is_file() || found.len() > FILE_BYTES_MAX {
        return None;
    }
    Adapter::parse(name, &fs::read_to_string(path).ok()?)
}

/// The adapter at a path that [`Adapter::syspath`] made.
pub fn read_syspath(dir: &Path, syspath: &str) -> Option<Adapter> {
    read(dir, syspath.strip_prefix(SYSPATH_PREFIX)?)
}

/// Every adapter in the directory, by name; none if it cannot be read.
pub fn list(dir: &Path) -> Vec<Adapter> {
    let names = fs::read_dir(dir).into_iter().flatten().flatten();
    let mut adapters: Vec<Adapter> = names
        .filter_map(|entry| read(dir, entry.file_name().to_str()?))
        .collect();
    adapters.sort_by(|a, b| a.name.cmp(&b.name));
    adapters
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_gives_its_properties_and_the_common_ones() {
        let text = "DEVNAME=/dev/pts/3\nID_VENDOR_ID=1a86\n\nnonsense\nID_MODEL_ENC=a\\x20b=c\n";
        let adapter = Adapter::parse("one", text).unwrap();
        assert_eq!(adapter.syspath(), "/sys/devices/motorlink/one");
        let property = |key: &std::ffi::CStr| adapter.properties[key].to_str().unwrap();
        assert_eq!(property(c"DEVNAME"), "/dev/pts/3");
        assert_eq!(property(c"ID_VENDOR_ID"), "1a86");
        assert_eq!(property(c"ID_MODEL_ENC"), "a\\x20b=c");
        assert_eq!(property(c"ID_BUS"), "usb");
        assert_eq!((property(c"MAJOR"), property(c"MINOR")), ("4", "64"));
        assert_eq!(adapter.properties.len(), 6);
    }

    #[test]
    fn no_node_or_a_hidden_name_is_no_adapter() {
        assert_eq!(Adapter::parse("one", "ID_VENDOR_ID=1a86\n"), None);
        assert_eq!(Adapter::parse(".one", "DEVNAME=/dev/pts/3\n"), None);
        assert_eq!(Adapter::parse("", "DEVNAME=/dev/pts/3\n"), None);
        assert_eq!(Adapter::parse("../one", "DEVNAME=/dev/pts/3\n"), None);
    }

    #[test]
    fn a_directory_lists_its_adapters_in_order() {
        let dir = tempfile::tempdir().unwrap();
        assert!(list(dir.path()).is_empty());
        for name in ["b", "a", ".c"] {
            fs::write(dir.path().join(name), "DEVNAME=/dev/pts/3\n").unwrap();
        }
        fs::write(dir.path().join("empty"), "").unwrap();
        fs::write(dir.path().join("huge"), "DEVNAME=/dev/pts/3\n".repeat(1000)).unwrap();
        let names: Vec<_> = list(dir.path())
            .into_iter()
            .map(|adapter| adapter.name)
            .collect();
        assert_eq!(names, ["a", "b"]);
        assert_eq!(
            read_syspath(dir.path(), "/sys/devices/motorlink/b")
                .unwrap()
                .name,
            "b"
        );
        assert_eq!(read_syspath(dir.path(), "/sys/devices/pci/b"), None);
        assert!(list(&dir.path().join("missing")).is_empty());
    }
}
