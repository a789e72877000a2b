//! The `udev` context: libudev's library handle. Ours carries no state.

use std::ffi::c_void;
use std::ptr;

/// Stands for every context: callers only ever compare it with null and hand it back.
static CONTEXT: u8 = 0;

/// Makes a context.
#[unsafe(no_mangle)]
pub extern "C" fn udev_new() -> *const c_void {
    ptr::from_ref(&CONTEXT).cast()
}

/// Drops a context. Always null, as libudev says.
#[unsafe(no_mangle)]
pub extern "C" fn udev_unref(_udev: *const c_void) -> *const c_void {
    ptr::null()
}
