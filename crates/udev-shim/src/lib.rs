//! Shows Chromium pseudo-terminals as USB serial adapters, by standing in for libudev.
//!
//! Chromium on Linux learns which serial ports exist, and when one is plugged or pulled, from
//! libudev, to which it links dynamically. Preloaded (`LD_PRELOAD`), this library answers those
//! calls from a directory instead of from the system, so an unmodified browser, headless and
//! without hardware, runs its real Web Serial stack against whatever is at the other end of a
//! pseudo-terminal.
//!
//! The directory is named by the environment variable `MOTORLINK_UDEV_DIR`. Each file in it is one
//! adapter, and says its udev properties one a line:
//!
//! ```text
//! DEVNAME=/dev/pts/7
//! ID_VENDOR_ID=1a86
//! ID_MODEL_ID=7523
//! ID_MODEL_ENC=USB\x20Serial
//! ID_SERIAL_SHORT=0001
//! ```
//!
//! Renaming a file into the directory plugs the adapter, deleting it pulls it. Files whose name
//! starts with a dot are no adapters, so one can be written in place and then renamed. Without the
//! variable there is no adapter and never will be.
//!
//! What it is not: a libudev. It knows the subsystem `tty` only; whatever else Chromium asks about
//! (disks, HID, USB, gamepads, cameras) it answers with nothing.

mod adapters;
mod context;
mod device;
mod enumerate;
mod inotify_event;
mod list_entry;
mod monitor;
