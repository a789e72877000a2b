//! Tells systemd that the server is ready, and that it lives.

use std::time::{Duration, Instant};

/// Tells systemd, if it has started this program.
pub struct Service {
    /// How often to say that the program lives, if systemd watches it.
    every: Option<Duration>,
    next: Instant,
}

impl Service {
    /// The server answers from now on.
    pub fn ready() -> Self {
        notify("READY=1");
        Self {
            // Twice before systemd takes it for dead.
            every: watchdog().map(|limit| limit / 3),
            next: Instant::now(),
        }
    }

    /// Says that the thread beside the driver lives. To be called often.
    pub fn notify_alive(&mut self) {
        let Some(every) = self.every else { return };
        let now = Instant::now();
        if now >= self.next {
            self.next = now + every;
            notify("WATCHDOG=1");
        }
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        notify("STOPPING=1");
    }
}

#[cfg(target_os = "linux")]
fn notify(state: &'static str) {
    // Without systemd nobody listens.
    let _ = sd_notify::notify(&[sd_notify::NotifyState::Custom(state)]);
}

#[cfg(target_os = "linux")]
fn watchdog() -> Option<Duration> {
    sd_notify::watchdog_enabled()
}

#[cfg(not(target_os = "linux"))]
fn notify(_state: &'static str) {}

#[cfg(not(target_os = "linux"))]
fn watchdog() -> Option<Duration> {
    None
}
