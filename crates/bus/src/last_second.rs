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

    /// The nine complete slots, but those since the newest, which are empty. The current one is left out.
    pub(crate) fn over(&self, now: Instant) -> impl Iterator<Item = T> {
        let current = slot_at(now).max(self.newest);
        (1..SLOTS as u64)
            .filter_map(move |back| current.checked_sub(back))
            .filter(|slot| *slot <= self.newest)
            .filter_map(|slot| self.slots.get(place(slot)).copied())
    }

    fn advance(&mut self, now: Instant) {
        let slot = slot_at(now);
        let passed = slot.saturating_sub(self.newest).min(SLOTS as u64);
        for back in 0..passed {
            if let Some(stale) = self.slots.get_mut(place(slot - back)) {
                *stale = T::default();
            }
        }
        self.newest = self.newest.max(slot);
    }
}

/// Number of the slot since the epoch.
const fn slot_at(now: Instant) -> u64 {
    now.as_micros() / SLOT_US
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "the remainder is below ten"
)]
const fn place(slot: u64) -> usize {
    (slot % SLOTS as u64) as usize
}
