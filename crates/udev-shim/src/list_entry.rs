//! `udev_list_entry`: a list of names, walked by C.

use std::ffi::{CString, c_char};
use std::ptr;

/// One name and the rest of the list.
#[derive(Debug)]
pub struct ListEntry {
    name: CString,
    next: Option<Box<ListEntry>>,
}

impl ListEntry {
    /// The list of these names in their order; none if there are none.
    pub fn list(names: impl DoubleEndedIterator<Item = CString>) -> Option<Box<Self>> {
        names
            .rev()
            .fold(None, |next, name| Some(Box::new(Self { name, next })))
    }
}

/// A list as C holds it: null when empty.
pub fn pointer(entry: Option<&ListEntry>) -> *const ListEntry {
    entry.map_or(ptr::null(), ptr::from_ref)
}

/// The next entry, or null after the last.
///
/// # Safety
///
/// `entry` is null or belongs to a list whose owner was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_list_entry_get_next(entry: *const ListEntry) -> *const ListEntry {
    // SAFETY: by contract null or live; a list is never changed while C can reach it.
    let entry = unsafe { entry.as_ref() };
    pointer(entry.and_then(|entry| entry.next.as_deref()))
}

/// The entry's name: for an enumeration, a device's syspath.
///
/// # Safety
///
/// As for [`udev_list_entry_get_next`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_list_entry_get_name(entry: *const ListEntry) -> *const c_char {
    // SAFETY: by contract null or live; a list is never changed while C can reach it.
    let entry = unsafe { entry.as_ref() };
    entry.map_or(ptr::null(), |entry| entry.name.as_ptr())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::CStr;

    #[test]
    fn c_walks_the_names_in_order() {
        let list = ListEntry::list([c"a".to_owned(), c"b".to_owned()].into_iter());
        let mut entry = pointer(list.as_deref());
        let mut names = Vec::new();
        while !entry.is_null() {
            // SAFETY: `list` lives to the end of the test.
            let name = unsafe { udev_list_entry_get_name(entry) };
            // SAFETY: a live entry's name is a C string.
            names.push(unsafe { CStr::from_ptr(name) });
            // SAFETY: `list` lives to the end of the test.
            entry = unsafe { udev_list_entry_get_next(entry) };
        }
        assert_eq!(names, [c"a", c"b"]);
        assert!(pointer(ListEntry::list([].into_iter()).as_deref()).is_null());
    }
}
