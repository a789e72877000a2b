//! One address of a full scan: what its probes have brought.

use motorlink_protocol::{Instant, MotorId};

/// Addresses 1-254.
pub(super) const ADDRESSES: u16 = 254;

/// Good replies that make a motor: one junk window in 256 has a good CRC by chance.
const REPLIES_WANTED: u8 = 2;

/// Most probes of one address per pass, if noise or a single reply asks for another.
pub(super) const PROBES_MAX: u8 = 6;

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Address {
    pub(super) probes: u8,
    pub(super) replies: u8,
    /// Whether the last probe brought noise.
    pub(super) noisy: bool,
    /// Clean windows in a row of the second look.
    pub(super) silences: u8,
    /// When it was last probed without an answer in its window.
    pub(super) unanswered: Option<Instant>,
}

impl Address {
    pub(super) const fn is_found(self) -> bool {
        self.replies >= REPLIES_WANTED
    }

    pub(super) const fn is_silent(self) -> bool {
        self.replies == 0 && !self.noisy
    }

    /// Whether another probe can decide about the address.
    pub(super) const fn is_doubtful(self) -> bool {
        !self.is_found() && !self.is_silent() && self.probes < PROBES_MAX
    }
}

pub(super) const fn place(id: MotorId) -> usize {
    id.get() as usize - 1
}
