//! How many mode switch frames it takes.

use motorlink_protocol::Mode;

/// Counts mode switch frames in a row for one mode. A switch frame for another mode restarts the count. Other frames do
/// not, because hosts drive on while they switch.
#[derive(Clone, Debug)]
pub(crate) struct ModeSwitchCount {
    needed: u8,
    row: Option<(Mode, u8)>,
}

impl ModeSwitchCount {
    pub(crate) const fn new(needed: u8) -> Self {
        Self { needed, row: None }
    }

    /// Whether this frame completes the row. The next one starts another.
    pub(crate) fn count(&mut self, mode: Mode) -> bool {
        let received = match self.row {
            Some((same, received)) if same == mode => received.saturating_add(1),
            _ => 1,
        };
        let complete = received >= self.needed;
        self.row = (!complete).then_some((mode, received));
        complete
    }
}
