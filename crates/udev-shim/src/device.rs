//! `udev_device`: one adapter, and what happened to it.

use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr;

use crate::adapters::{self, Adapter, SUBSYSTEM};

/// What a monitor reports of a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// It was plugged.
    Add,
    /// It was pulled.
    Remove,
}

/// A device as handed to C: it owns every string that its accessors point to.
pub struct Device {
    properties: BTreeMap<CString, CString>,
    syspath: CString,
    sysname: CString,
    subsystem: CString,
    action: Option<CString>,
}

impl Device {
    /// The device of an adapter; `action` is what a monitor saw, none when enumerated.
    pub fn new(adapter: Adapter, action: Option<Action>) -> Option<Self> {
        let action = match action {
            None => None,
            Some(Action::Add) => Some(c"add".to_owned()),
            Some(Action::Remove) => Some(c"remove".to_owned()),
        };
        Some(Self {
            syspath: CString::new(adapter.syspath()).ok()?,
            sysname: CString::new(adapter.name).ok()?,
            subsystem: CString::new(SUBSYSTEM).ok()?,
            properties: adapter.properties,
            action,
        })
    }

    fn property(&self, key: &CStr) -> Option<&CStr> {
        self.properties.get(key).map(CString::as_c_str)
    }
}

/// Hands a device, if there is one, over to the C side, which frees it by [`udev_device_unref`].
pub fn hand_over(device: Option<Device>) -> *mut Device {
    device.map_or(ptr::null_mut(), |device| Box::into_raw(Box::new(device)))
}

fn pointer(string: Option<&CStr>) -> *const c_char {
    string.map_or(ptr::null(), CStr::as_ptr)
}

/// A string of a device that C handed us, as a C string: null for a null device or no such string.
///
/// # Safety
///
/// `device` is null or came from [`hand_over`] and was not freed. The pointer lives as long as it.
unsafe fn string_of(
    device: *const Device,
    get: impl FnOnce(&Device) -> Option<&CStr>,
) -> *const c_char {
    // SAFETY: by this function's contract the pointer is null or a live device, which the shim
    // never changes once it is handed over, so a shared borrow is sound.
    let device = unsafe { device.as_ref() };
    pointer(device.and_then(get))
}

/// Frees a device. Always null, as libudev says.
///
/// # Safety
///
/// `device` is null or came from this library and was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_device_unref(device: *mut Device) -> *mut Device {
    if !device.is_null() {
        // SAFETY: a non-null device came from `Box::into_raw` in `hand_over`, and the caller gives
        // up its only reference: Chromium never calls `udev_device_ref`, and we export none.
        drop(unsafe { Box::from_raw(device) });
    }
    ptr::null_mut()
}

/// The device at a syspath, or null.
///
/// # Safety
///
/// `syspath` is null or a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_device_new_from_syspath(
    _udev: *const c_void,
    syspath: *const c_char,
) -> *mut Device {
    if syspath.is_null() {
        return ptr::null_mut();
    }
    // SAFETY: not null, and by contract a C string that outlives this call.
    let syspath = unsafe { CStr::from_ptr(syspath) };
    let found = adapters::directory().zip(syspath.to_str().ok());
    let adapter = found.and_then(|(dir, syspath)| adapters::read_syspath(&dir, syspath));
    hand_over(adapter.and_then(|adapter| Device::new(adapter, None)))
}

/// Null: asked about disks, of which we know none.
#[unsafe(no_mangle)]
pub extern "C" fn udev_device_new_from_devnum(
    _udev: *const c_void,
    _kind: c_char,
    _devnum: u64,
) -> *mut Device {
    ptr::null_mut()
}

/// Null: asked about network cards and cameras, of which we know none.
#[unsafe(no_mangle)]
pub extern "C" fn udev_device_new_from_subsystem_sysname(
    _udev: *const c_void,
    _subsystem: *const c_char,
    _sysname: *const c_char,
) -> *mut Device {
    ptr::null_mut()
}

/// `add` or `remove` for a device from a monitor, null for one enumerated.
///
/// # Safety
///
/// As for [`string_of`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_device_get_action(device: *const Device) -> *const c_char {
    // SAFETY: passed through from our caller.
    unsafe { string_of(device, |device| device.action.as_deref()) }
}

/// The path of the device node.
///
/// # Safety
///
/// As for [`string_of`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_device_get_devnode(device: *const Device) -> *const c_char {
    // SAFETY: passed through from our caller.
    unsafe { string_of(device, |device| device.property(c"DEVNAME")) }
}

/// `tty`.
///
/// # Safety
///
/// As for [`string_of`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_device_get_subsystem(device: *const Device) -> *const c_char {
    // SAFETY: passed through from our caller.
    unsafe { string_of(device, |device| Some(&device.subsystem)) }
}

/// The device's place in sysfs, by which Chromium pairs a removal with its addition.
///
/// # Safety
///
/// As for [`string_of`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_device_get_syspath(device: *const Device) -> *const c_char {
    // SAFETY: passed through from our caller.
    unsafe { string_of(device, |device| Some(&device.syspath)) }
}

/// The last part of the syspath.
///
/// # Safety
///
/// As for [`string_of`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_device_get_sysname(device: *const Device) -> *const c_char {
    // SAFETY: passed through from our caller.
    unsafe { string_of(device, |device| Some(&device.sysname)) }
}

/// One udev property, or null.
///
/// # Safety
///
/// As for [`string_of`], and `key` is null or a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_device_get_property_value(
    device: *const Device,
    key: *const c_char,
) -> *const c_char {
    if key.is_null() {
        return ptr::null();
    }
    // SAFETY: not null, and by contract a C string that outlives this call.
    let key = unsafe { CStr::from_ptr(key) };
    // SAFETY: passed through from our caller.
    unsafe { string_of(device, |device| device.property(key)) }
}

/// Null: a tty has no devtype.
#[unsafe(no_mangle)]
pub extern "C" fn udev_device_get_devtype(_device: *const Device) -> *const c_char {
    ptr::null()
}

/// Null: Chromium wants no driver of a tty.
#[unsafe(no_mangle)]
pub extern "C" fn udev_device_get_driver(_device: *const Device) -> *const c_char {
    ptr::null()
}

/// Null: there are no attributes, only properties.
#[unsafe(no_mangle)]
pub extern "C" fn udev_device_get_sysattr_value(
    _device: *const Device,
    _name: *const c_char,
) -> *const c_char {
    ptr::null()
}

/// Null: a device here hangs on nothing.
#[unsafe(no_mangle)]
pub extern "C" fn udev_device_get_parent(_device: *const Device) -> *mut Device {
    ptr::null_mut()
}

/// Null: a device here hangs on nothing.
#[unsafe(no_mangle)]
pub extern "C" fn udev_device_get_parent_with_subsystem_devtype(
    _device: *const Device,
    _subsystem: *const c_char,
    _devtype: *const c_char,
) -> *mut Device {
    ptr::null_mut()
}

/// Null: properties are only ever asked for by name of the devices that we show.
#[unsafe(no_mangle)]
pub extern "C" fn udev_device_get_properties_list_entry(_device: *const Device) -> *const c_void {
    ptr::null()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn c_reads_what_the_adapter_says() {
        let adapter = Adapter::parse("one", "DEVNAME=/dev/pts/3").unwrap();
        let device = hand_over(Device::new(adapter, Some(Action::Remove)));
        let read = |pointer: *const c_char| {
            // SAFETY: the accessors return null or a C string of the device, which still lives.
            (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) }.to_str().unwrap())
        };
        // SAFETY: `device` came from `hand_over` and is freed once, at the end.
        let (node, action, subsystem, bus, absent) = unsafe {
            (
                read(udev_device_get_devnode(device)),
                read(udev_device_get_action(device)),
                read(udev_device_get_subsystem(device)),
                read(udev_device_get_property_value(device, c"ID_BUS".as_ptr())),
                read(udev_device_get_property_value(device, c"ID_MODEL".as_ptr())),
            )
        };
        assert_eq!(node, Some("/dev/pts/3"));
        assert_eq!(action, Some("remove"));
        assert_eq!(subsystem, Some("tty"));
        assert_eq!(bus, Some("usb"));
        assert_eq!(absent, None);
        // SAFETY: as above.
        assert!(unsafe { udev_device_unref(device) }.is_null());
    }

    #[test]
    fn null_asks_nothing_and_frees_nothing() {
        // SAFETY: null is allowed by contract.
        assert!(unsafe { udev_device_get_syspath(ptr::null()) }.is_null());
        // SAFETY: null is allowed by contract.
        assert!(unsafe { udev_device_unref(ptr::null_mut()) }.is_null());
    }
}
