//! Sums over the last second, in ten slots of 100 ms.

use motorlink_protocol::Instant;

const SLOTS: usize = 10;
const SLOT_US: u64 = 100_000;

/// Total length of the slots of [`LastSecond::over`] in microseconds.
pub(crate) const OVER_US: u64 = (SLOTS as u64 - 1) * SLOT_US;

/// A ring buffer of ten slots. Every 100 ms the oldest is cleared.
#[derive(Clone, Debug, Default)]
pub(crate) struct LastSecond<T> {
    slots: [T; SLOTS],
    /// Number of the current slot since the epoch.
    newest: u64,
}

impl<T: Copy + Default> LastSecond<T> {
    /// The current slot.
    pub(crate) fn now(&mut self, now: Instant) -> &mut T {
        self.advance(now);
        #[allow(clippy::indexing_slicing, reason = "the remainder is below ten")]
        &mut self.slots[place(self.newest)]
    }

    /// The nine complete slots. The current one is left out.
    pub(crate) fn over(&self, now: Instant) -> impl Iterator<Item = T> {
        let mut moved = self.clone();
        moved.advance(now);
        let current = place(moved.newest);
        let slots = moved.slots.into_iter().enumerate();
        slots
            .filter(move |(number, _)| *number != current)
            .map(|(_, slot)| slot)
    }

    fn advance(&mut self, now: Instant) {
        let slot = now.as_micros() / SLOT_US;
        let passed = slot.saturating_sub(self.newest).min(SLOTS as u64);
        for back in 0..passed {
            if let Some(stale) = self.slots.get_mut(place(slot - back)) {
                *stale = T::default();
            }
        }
        self.newest = self.newest.max(slot);
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "the remainder is below ten"
)]
const fn place(slot: u64) -> usize {
    (slot % SLOTS as u64) as usize
}
