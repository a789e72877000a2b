//! What happened on a line, counted.

use std::ops::AddAssign;

use motorlink_bus::Counters;

/// Ends of exchanges and oddities, in a time or of a kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Requests that expect a reply.
    pub asked: u32,
    /// Good replies in time.
    pub answered: u32,
    /// Exchanges without a reply, apart from an echo.
    pub silent: u32,
    /// Windows in which bytes came and no good frame.
    pub garbled: u32,
    /// Requests that came back, whole or cut short.
    pub echoed: u32,
    /// Good frames of a motor that was not asked.
    pub foreign: u32,
    /// Replies after their window. Each is among the silent or the garbled, too.
    pub late: u32,
    /// Bytes of a pair that nothing drives.
    pub levels: u32,
    /// Bytes of text.
    pub text: u32,
    /// Chunks of 32 bytes.
    pub blocks: u32,
}

impl Tally {
    /// What was counted after `earlier`; nothing where counting started again.
    pub fn since(earlier: &Counters, later: &Counters) -> Self {
        let more = |of: fn(&Counters) -> u64| {
            let more = of(later).saturating_sub(of(earlier));
            u32::try_from(more).unwrap_or(u32::MAX)
        };
        Self {
            asked: more(|counters| counters.requests),
            answered: more(|counters| counters.replies),
            silent: more(|counters| counters.silences),
            garbled: more(garbled),
            echoed: more(echoed),
            foreign: more(|counters| counters.wrong_ids),
            late: more(|counters| counters.late),
            levels: more(|counters| counters.level_bytes),
            text: more(|counters| counters.text_bytes),
            blocks: more(|counters| counters.blocks),
        }
    }

    /// With the request that was sent just before and ended since: no more go unanswered than were sent.
    pub(crate) fn with_requests_of_before(mut self) -> Self {
        let ended = self.silent.saturating_add(self.garbled);
        self.asked = self.asked.max(ended);
        self
    }

    /// Requests without a good reply. A late reply is not lost.
    pub(crate) const fn lost(&self) -> u32 {
        self.silent
            .saturating_add(self.garbled)
            .saturating_sub(self.late)
    }

    /// Those among the requests, in per mille.
    pub(crate) fn lost_per_mille(&self) -> u32 {
        per_mille(self.lost(), self.asked)
    }

    /// Spent windows among the requests, in per mille.
    pub(crate) fn garbled_per_mille(&self) -> u32 {
        per_mille(self.garbled, self.asked)
    }
}

impl AddAssign for Tally {
    /// Out of line: its callers are many.
    #[inline(never)]
    fn add_assign(&mut self, other: Self) {
        let add = |sum: &mut u32, more: u32| *sum = sum.saturating_add(more);
        add(&mut self.asked, other.asked);
        add(&mut self.answered, other.answered);
        add(&mut self.silent, other.silent);
        add(&mut self.garbled, other.garbled);
        add(&mut self.echoed, other.echoed);
        add(&mut self.foreign, other.foreign);
        add(&mut self.late, other.late);
        add(&mut self.levels, other.levels);
        add(&mut self.text, other.text);
        add(&mut self.blocks, other.blocks);
    }
}

/// Windows in which bytes came and no good frame.
#[must_use]
pub const fn garbled(counters: &Counters) -> u64 {
    counters.bad_crcs.saturating_add(counters.fragments)
}

/// Requests that came back, whole or cut short.
#[must_use]
pub const fn echoed(counters: &Counters) -> u64 {
    counters.echoes_whole.saturating_add(counters.echoes_cut)
}

fn per_mille(part: u32, whole: u32) -> u32 {
    let share = u64::from(part) * 1_000 / u64::from(whole.max(1));
    u32::try_from(share).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_requests_go_unanswered_than_were_sent() {
        let counts = Tally {
            asked: 22,
            silent: 23,
            ..Tally::default()
        };
        assert_eq!(counts.with_requests_of_before().asked, 23);
        assert_eq!(Tally::default().with_requests_of_before().asked, 0);
    }
}
