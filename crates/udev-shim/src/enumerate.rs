//! `udev_enumerate`: which devices there are at this moment.

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr;

use crate::adapters::{self, SUBSYSTEM};
use crate::list_entry::{self, ListEntry};

/// An enumeration: what was asked for, and after the scan what was found.
#[derive(Default)]
pub struct Enumerate {
    subsystems: Vec<CString>,
    found: Option<Box<ListEntry>>,
}

impl Enumerate {
    /// Without a filter every device is wanted, with filters those of any subsystem named.
    fn wants_serial_ports(&self) -> bool {
        self.subsystems.is_empty()
            || self
                .subsystems
                .iter()
                .any(|name| name.as_bytes() == SUBSYSTEM.as_bytes())
    }

    fn scan(&mut self) {
        let dir = adapters::directory().filter(|_| self.wants_serial_ports());
        let adapters = dir.map(|dir| adapters::list(&dir)).unwrap_or_default();
        let syspaths = adapters
            .iter()
            .filter_map(|adapter| CString::new(adapter.syspath()).ok());
        self.found = ListEntry::list(syspaths);
    }
}

/// Starts an enumeration.
#[unsafe(no_mangle)]
pub extern "C" fn udev_enumerate_new(_udev: *const c_void) -> *mut Enumerate {
    Box::into_raw(Box::default())
}

/// Frees an enumeration and its list. Always null, as libudev says.
///
/// # Safety
///
/// `enumerate` is null or came from [`udev_enumerate_new`] and was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_enumerate_unref(enumerate: *mut Enumerate) -> *mut Enumerate {
    if !enumerate.is_null() {
        // SAFETY: by contract it came from `Box::into_raw`, and the caller gives it up.
        drop(unsafe { Box::from_raw(enumerate) });
    }
    ptr::null_mut()
}

/// Adds a subsystem to those wanted. 0, or -1 for a null argument.
///
/// # Safety
///
/// `enumerate` is null or live and used by this thread alone; `subsystem` is null or a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_enumerate_add_match_subsystem(
    enumerate: *mut Enumerate,
    subsystem: *const c_char,
) -> c_int {
    // SAFETY: by contract null or live, and nobody else holds it: libudev objects belong to one
    // thread at a time.
    let Some(enumerate) = (unsafe { enumerate.as_mut() }) else {
        return -1;
    };
    if subsystem.is_null() {
        return -1;
    }
    // SAFETY: not null, and by contract a C string that outlives this call.
    let subsystem = unsafe { CStr::from_ptr(subsystem) };
    enumerate.subsystems.push(subsystem.to_owned());
    0
}

/// Looks which devices there are. 0, or -1 for a null argument.
///
/// # Safety
///
/// `enumerate` is null or live and used by this thread alone; a list taken from it before ends.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_enumerate_scan_devices(enumerate: *mut Enumerate) -> c_int {
    // SAFETY: by contract null or live, and nobody else holds it.
    let Some(enumerate) = (unsafe { enumerate.as_mut() }) else {
        return -1;
    };
    enumerate.scan();
    0
}

/// The devices found, as syspaths; null if none. The list lives as long as the enumeration.
///
/// # Safety
///
/// `enumerate` is null or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_enumerate_get_list_entry(
    enumerate: *const Enumerate,
) -> *const ListEntry {
    // SAFETY: by contract null or live.
    let enumerate = unsafe { enumerate.as_ref() };
    list_entry::pointer(enumerate.and_then(|enumerate| enumerate.found.as_deref()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_an_enumeration_that_may_want_ttys_gets_them() {
        let wanting = |subsystems: &[&CStr]| {
            let subsystems = subsystems.iter().map(|name| CString::from(*name)).collect();
            Enumerate {
                subsystems,
                found: None,
            }
            .wants_serial_ports()
        };
        assert!(wanting(&[]));
        assert!(wanting(&[c"usb", c"tty"]));
        assert!(!wanting(&[c"usb"]));
        assert!(!wanting(&[c"hid", c"ttyusb"]));
    }
}
