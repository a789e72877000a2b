//! A pair of wires that nothing holds at a level.

use std::time::Duration;

use motorlink_protocol::Instant;

use crate::random::Random;

/// Times between two bytes of noise, in milliseconds.
const PERIOD_MS: std::ops::RangeInclusive<u64> = 2..=19;

/// When the next byte of noise comes.
#[derive(Clone, Debug)]
pub(crate) struct FloatingPair {
    chance: Random,
    next: Option<Instant>,
}

impl FloatingPair {
    pub(crate) const fn new(chance: Random) -> Self {
        Self { chance, next: None }
    }

    /// When the next byte comes, if the pair floats.
    pub(crate) const fn next(&self) -> Option<Instant> {
        self.next
    }

    /// When the next byte comes, if that is by `until`. `floats` is whether the pair floats, `since` when it began at
    /// the latest.
    pub(crate) fn due(&mut self, floats: bool, since: Instant, until: Instant) -> Option<Instant> {
        if !floats {
            self.next = None;
            return None;
        }
        let next = *self.next.get_or_insert(since);
        (next <= until).then_some(next)
    }

    /// The byte of this time has come.
    pub(crate) fn passed(&mut self, at: Instant) {
        let more = usize::try_from(PERIOD_MS.end() - PERIOD_MS.start()).unwrap_or_default();
        let extra = u64::try_from(self.chance.below(more + 1)).unwrap_or_default();
        self.next = Some(at + Duration::from_millis(PERIOD_MS.start() + extra));
    }
}
