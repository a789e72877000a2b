//! When the bus may enable a motor without a command.

use motorlink_protocol::Instant;

use crate::timing::{ENABLE_PERIOD, ENABLE_TRIES};

/// The tries to enable a motor since it was last enabled, or silent for as long as a motor that lost power.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Enabling {
    tries: u8,
    last: Option<Instant>,
}

impl Enabling {
    /// Whether the bus may try now. The frame, or its answer, may be lost, but a motor that refuses is left alone.
    pub(crate) fn may_try(&self, now: Instant) -> bool {
        let is_soon = self
            .last
            .is_some_and(|last| now.since(last) < ENABLE_PERIOD);
        self.tries < ENABLE_TRIES && !is_soon
    }

    pub(crate) fn tried(&mut self, now: Instant) {
        self.tries += 1;
        self.last = Some(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bus_tries_three_times_a_second_apart() {
        let mut enabling = Enabling::default();
        let tries = (0..10_000).filter(|ms| {
            let now = Instant::from_millis(*ms);
            let may = enabling.may_try(now);
            if may {
                enabling.tried(now);
            }
            may
        });
        assert_eq!(tries.collect::<Vec<_>>(), [0, 1_000, 2_000]);
    }
}
