//! The port of the simulated computer.

use motorlink_protocol::Instant;

/// The adapter and its port.
#[derive(Debug, Default)]
pub(super) struct Port {
    /// When an unplugged adapter is plugged in again; `None` while it is there.
    pub(super) back_at: Option<Instant>,
    /// The name of the port has this number.
    pub(super) name: u32,
    /// How often the adapter was unplugged. A line that was opened before is dead.
    pub(super) unplugged: u32,
    /// The number that the driver has given to the open line.
    pub(super) open: Option<u32>,
    pub(super) refuses_until: Instant,
    pub(super) stalls_until: Instant,
}

impl Port {
    /// Whether it opens, takes and gives.
    pub(super) fn is_well(&self, now: Instant) -> bool {
        self.back_at.is_none() && !self.is_stalled(now) && now >= self.refuses_until
    }

    pub(super) fn is_stalled(&self, now: Instant) -> bool {
        now < self.stalls_until
    }

    /// The name of the port now; `None` while it is not there.
    pub(super) fn path(&self) -> Option<String> {
        self.back_at
            .is_none()
            .then(|| format!("port {}", self.name))
    }
}
