//! `udev_monitor`: adapters that come and go.
//!
//! The descriptor that Chromium polls is an inotify watch of the adapters' directory itself, so
//! there is no thread and no queue of ours that could disagree with it.

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::os::fd::{AsRawFd, OwnedFd};
use std::path::PathBuf;
use std::ptr;

use rustix::fs::inotify::{self, CreateFlags, WatchFlags};
use rustix::io::Errno;

use crate::adapters::{self, Adapter, SUBSYSTEM};
use crate::device::{self, Action, Device};
use crate::inotify_event::{FileEvent, HEADER_BYTES, NAME_BYTES_MAX, NAME_STEP_BYTES};

/// A monitor: what it listens for, and where.
pub struct Monitor {
    subsystems: Vec<CString>,
    inotify: OwnedFd,
    dir: Option<PathBuf>,
}

impl Monitor {
    fn new() -> Option<Self> {
        let inotify = inotify::init(CreateFlags::CLOEXEC | CreateFlags::NONBLOCK).ok()?;
        Some(Self {
            subsystems: Vec::new(),
            inotify,
            dir: adapters::directory(),
        })
    }

    /// Starts to listen, if serial ports may be wanted; otherwise the descriptor stays silent.
    fn enable(&self) -> rustix::io::Result<()> {
        let wanted = self.subsystems.is_empty()
            || self
                .subsystems
                .iter()
                .any(|name| name.as_bytes() == SUBSYSTEM.as_bytes());
        match &self.dir {
            Some(dir) if wanted => {
                // A file being written is no adapter yet: only its renaming into place counts.
                let changes = WatchFlags::MOVED_TO | WatchFlags::MOVED_FROM | WatchFlags::DELETE;
                inotify::add_watch(&self.inotify, dir, changes | WatchFlags::ONLYDIR).map(drop)
            }
            _ => Ok(()),
        }
    }

    /// The next adapter that came or went; none if the next event is about no adapter, or if there
    /// is no event.
    fn receive(&self) -> Option<Device> {
        let mut buffer = [0; HEADER_BYTES + NAME_BYTES_MAX];
        let event = FileEvent::parse(self.read_one(&mut buffer)?)?;
        let adapter = match event.action {
            Action::Add => adapters::read(self.dir.as_deref()?, event.name),
            Action::Remove => Adapter::unplugged(event.name),
        };
        Device::new(adapter?, Some(event.action))
    }

    /// Reads exactly one event. Chromium reads one device each time the descriptor polls readable,
    /// so a second event taken along would wait in our memory with nobody to ask for it. The kernel
    /// fills a buffer with whole events and refuses one too small for the first, so the smallest
    /// buffer that it accepts holds one.
    fn read_one<'a>(&self, buffer: &'a mut [u8]) -> Option<&'a [u8]> {
        let mut len_max = HEADER_BYTES;
        loop {
            match rustix::io::read(&self.inotify, buffer.get_mut(..len_max)?) {
                Ok(len) => return buffer.get(..len),
                Err(Errno::INVAL) => len_max += NAME_STEP_BYTES,
                Err(Errno::INTR) => {}
                Err(_) => return None,
            }
        }
    }
}

/// Makes a monitor, or null if the system has no inotify to spare.
#[unsafe(no_mangle)]
pub extern "C" fn udev_monitor_new_from_netlink(
    _udev: *const c_void,
    _name: *const c_char,
) -> *mut Monitor {
    Monitor::new().map_or(ptr::null_mut(), |monitor| Box::into_raw(Box::new(monitor)))
}

/// Frees a monitor and closes its descriptor. Always null, as libudev says.
///
/// # Safety
///
/// `monitor` is null or came from [`udev_monitor_new_from_netlink`] and was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_monitor_unref(monitor: *mut Monitor) -> *mut Monitor {
    if !monitor.is_null() {
        // SAFETY: by contract it came from `Box::into_raw`, and the caller gives it up.
        drop(unsafe { Box::from_raw(monitor) });
    }
    ptr::null_mut()
}

/// Adds a subsystem to those listened for. 0, or -1 for a null argument.
///
/// # Safety
///
/// `monitor` is null or live and used by this thread alone; `subsystem` is null or a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_monitor_filter_add_match_subsystem_devtype(
    monitor: *mut Monitor,
    subsystem: *const c_char,
    _devtype: *const c_char,
) -> c_int {
    // SAFETY: by contract null or live, and nobody else holds it: libudev objects belong to one
    // thread at a time.
    let Some(monitor) = (unsafe { monitor.as_mut() }) else {
        return -1;
    };
    if subsystem.is_null() {
        return -1;
    }
    // SAFETY: not null, and by contract a C string that outlives this call.
    let subsystem = unsafe { CStr::from_ptr(subsystem) };
    monitor.subsystems.push(subsystem.to_owned());
    0
}

/// Starts to listen. 0, or a negative number.
///
/// # Safety
///
/// `monitor` is null or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_monitor_enable_receiving(monitor: *const Monitor) -> c_int {
    // SAFETY: by contract null or live.
    let Some(monitor) = (unsafe { monitor.as_ref() }) else {
        return -1;
    };
    monitor
        .enable()
        .map_or_else(|error| -error.raw_os_error(), |()| 0)
}

/// The descriptor to poll, or -1 for null.
///
/// # Safety
///
/// `monitor` is null or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_monitor_get_fd(monitor: *const Monitor) -> c_int {
    // SAFETY: by contract null or live.
    let monitor = unsafe { monitor.as_ref() };
    monitor.map_or(-1, |monitor| monitor.inotify.as_raw_fd())
}

/// The next device that came or went, or null.
///
/// # Safety
///
/// `monitor` is null or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn udev_monitor_receive_device(monitor: *const Monitor) -> *mut Device {
    // SAFETY: by contract null or live.
    let monitor = unsafe { monitor.as_ref() };
    device::hand_over(monitor.and_then(Monitor::receive))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::path::Path;

    fn listening_to(dir: &Path, subsystems: &[&CStr]) -> Monitor {
        let monitor = Monitor {
            subsystems: subsystems.iter().map(|name| CString::from(*name)).collect(),
            dir: Some(dir.to_owned()),
            ..Monitor::new().unwrap()
        };
        monitor.enable().unwrap();
        monitor
    }

    fn plug(dir: &Path, name: &str) {
        let hidden = dir.join(".new");
        fs::write(&hidden, "DEVNAME=/dev/pts/3\n").unwrap();
        fs::rename(hidden, dir.join(name)).unwrap();
    }

    /// Everything that the monitor reports, read as Chromium does: once for each time that the
    /// descriptor is readable.
    fn reports(monitor: &Monitor) -> Vec<(String, Option<String>)> {
        let readable = || {
            use rustix::event::{PollFd, PollFlags, Timespec, poll};
            let now = Timespec {
                tv_sec: 0,
                tv_nsec: 0,
            };
            poll(
                &mut [PollFd::new(&monitor.inotify, PollFlags::IN)],
                Some(&now),
            ) == Ok(1)
        };
        let mut reports = Vec::new();
        while readable() {
            let device = device::hand_over(monitor.receive());
            if device.is_null() {
                continue;
            }
            // SAFETY: the device is live until freed below, and a syspath is never null.
            let syspath = unsafe { CStr::from_ptr(device::udev_device_get_syspath(device)) };
            // SAFETY: the same, and a device from a monitor has an action.
            let action = unsafe { CStr::from_ptr(device::udev_device_get_action(device)) };
            let name = syspath
                .to_str()
                .unwrap()
                .rsplit('/')
                .next()
                .map(str::to_owned);
            reports.push((action.to_str().unwrap().to_owned(), name));
            // SAFETY: handed over above, freed once.
            unsafe { device::udev_device_unref(device) };
        }
        reports
    }

    fn report(action: &str, name: &str) -> (String, Option<String>) {
        (action.to_owned(), Some(name.to_owned()))
    }

    #[test]
    fn every_plug_and_pull_is_reported_once_and_in_order() {
        let dir = tempfile::tempdir().unwrap();
        let monitor = listening_to(dir.path(), &[]);
        assert_eq!(reports(&monitor), []);
        let long = "an-adapter-with-a-name-of-more-than-thirty-two-bytes";
        plug(dir.path(), "a");
        plug(dir.path(), long);
        assert_eq!(reports(&monitor), [report("add", "a"), report("add", long)]);
        fs::remove_file(dir.path().join("a")).unwrap();
        assert_eq!(reports(&monitor), [report("remove", "a")]);
        plug(dir.path(), "a");
        assert_eq!(reports(&monitor), [report("add", "a")]);
    }

    #[test]
    fn a_monitor_of_other_things_stays_silent() {
        let dir = tempfile::tempdir().unwrap();
        let monitor = listening_to(dir.path(), &[c"usb"]);
        plug(dir.path(), "a");
        assert_eq!(reports(&monitor), []);
    }
}
