//! What the system grants to a thread that must be on time.

use thread_priority::{ThreadPriority, set_current_thread_priority};

/// Asks for timely wake-ups and a high priority for this thread. A system that refuses leaves it as it is: frames are
/// later on a busy computer then, and the bus says so.
pub(crate) fn run_on_time() {
    // Linux lets a timer be 50 us late by default.
    #[cfg(target_os = "linux")]
    let _ = rustix::thread::set_current_timer_slack(Some(std::num::NonZeroU64::MIN));
    #[cfg(target_os = "linux")]
    let is_real_time = {
        use thread_priority::{
            RealtimeThreadSchedulePolicy::Fifo, ThreadSchedulePolicy::Realtime,
            set_thread_priority_and_policy, thread_native_id,
        };
        let least =
            ThreadPriority::from_posix(thread_priority::ScheduleParams { sched_priority: 1 });
        set_thread_priority_and_policy(thread_native_id(), least, Realtime(Fifo)).is_ok()
    };
    #[cfg(not(target_os = "linux"))]
    let is_real_time = false;
    if !is_real_time {
        let _ = set_current_thread_priority(ThreadPriority::Max);
    }
}

/// Asks the adapter of this port to deliver bytes at once: one by FTDI holds them for 16 ms by default.
#[cfg(target_os = "linux")]
pub(crate) fn ask_for_low_latency(path: &str) {
    use std::{fs, path::Path};

    let Ok(port) = fs::canonicalize(path) else {
        return;
    };
    let name = port.file_name().unwrap_or_default();
    let timer = Path::new("/sys/class/tty")
        .join(name)
        .join("device/latency_timer");
    if timer.exists() {
        // Refused to an ordinary user: then replies are late, and the diagnosis names the adapter.
        let _ = fs::write(timer, "1");
    }
}

/// Other systems have a setting of the driver for it.
#[cfg(not(target_os = "linux"))]
pub(crate) fn ask_for_low_latency(_path: &str) {}
