//! The wire comes first: where drawing delays frames or replies, the page draws less often.
//!
//! On a machine without a GPU the browser draws on the cores that the port worker needs. The bus counts what is
//! late ([`LineStatus::late_hz`]). The governor looks at it once a second, judges every three seconds, and lowers the
//! frame rate until the wire is on time. Where that does not help, drawing is not the cause, and the page draws as
//! before.

use motorlink_messages::{bus::LineStatus, protocol::Instant};

use crate::ui::frame_rate::FrameRate;

const SECOND_US: u64 = 1_000_000;

/// The bus counts over the last second.
const LOOK_EVERY_US: u64 = SECOND_US;
/// A longer time between two looks is a gap: the page hung, and nothing follows from what was before.
const GAP_US: u64 = 2 * SECOND_US;
/// Looks of one judgement: the lateness of a single second is chance.
const LOOKS: u32 = 3;
/// From this many exchanges a second on the governor works, and below the other it rests: with fewer, nothing is
/// driven at a rate that drawing could disturb.
const WORKS_FROM_HZ: u16 = 30;
const RESTS_BELOW_HZ: u16 = 20;
/// More of the exchanges late than this, and at least so many: the rate goes down.
const LATE_MAX_PER_MILLE: u32 = 50;
const LATE_MIN: u32 = 8;
/// At most so many of the exchanges late, or so many in all, for a while: the rate goes up.
const CALM_PER_MILLE: u32 = 25;
const CALM_MAX: u32 = 4;
/// How long the wire is on time before the rate goes up. Twice as long after each raise that was undone
/// [`TOO_SOON_US`].
const RAISE_AFTER_US: u64 = 5 * SECOND_US;
const RAISE_AFTER_MAX_US: u64 = 80 * SECOND_US;
/// A rate that has to be lowered so soon after it was raised was raised too soon.
const TOO_SOON_US: u64 = 10 * SECOND_US;
/// How long the page draws as before where drawing less did not help.
const GIVEN_UP_FOR_US: u64 = 60 * SECOND_US;

/// Decides the frame rate from what is late on the wire.
#[derive(Clone, Debug)]
pub(crate) struct Governor {
    rate: FrameRate,
    works: bool,
    /// Microseconds on the worker's clock, here and below.
    looked: u64,
    /// Looks since the last judgement, and what they have counted.
    looks: u32,
    late: u32,
    exchanges: u32,
    /// Late exchanges, per mille, when the rate was last lowered from the full one.
    late_at_full: u32,
    calm_since: Option<u64>,
    raised: Option<u64>,
    raise_after: u64,
    given_up_until: Option<u64>,
}

impl Default for Governor {
    fn default() -> Self {
        Self {
            rate: FrameRate::Full,
            works: false,
            looked: 0,
            looks: 0,
            late: 0,
            exchanges: 0,
            late_at_full: 0,
            calm_since: None,
            raised: None,
            raise_after: RAISE_AFTER_US,
            given_up_until: None,
        }
    }
}

impl Governor {
    /// The frame rate from now on. `line` is `None` while no port is open. A hidden page draws nothing, and nothing
    /// follows from what is late meanwhile.
    pub(crate) fn look(
        &mut self,
        now: Instant,
        line: Option<&LineStatus>,
        is_hidden: bool,
    ) -> FrameRate {
        let Some(line) = line else {
            *self = Self::default();
            return self.rate;
        };
        let now = now.as_micros();
        let since_look = now.saturating_sub(self.looked);
        if since_look < LOOK_EVERY_US {
            return self.rate_if_works();
        }
        let has_gap = since_look > GAP_US;
        self.looked = now;
        let least = if self.works {
            RESTS_BELOW_HZ
        } else {
            WORKS_FROM_HZ
        };
        let worked = self.works;
        self.works = line.exchanges_hz >= least;
        if !self.works || !worked || has_gap || is_hidden {
            self.restart();
            return self.rate_if_works();
        }
        self.looks += 1;
        self.late += u32::from(line.late_hz);
        self.exchanges += u32::from(line.exchanges_hz);
        if self.looks >= LOOKS {
            self.judge(now);
            (self.looks, self.late, self.exchanges) = (0, 0, 0);
        }
        self.rate
    }

    /// While it rests the page draws fully. The rate is kept for the next drive.
    const fn rate_if_works(&self) -> FrameRate {
        if self.works {
            self.rate
        } else {
            FrameRate::Full
        }
    }

    /// Forgets what it has counted, and keeps the rate.
    const fn restart(&mut self) {
        (self.looks, self.late, self.exchanges) = (0, 0, 0);
        self.calm_since = None;
        self.raised = None;
    }

    fn judge(&mut self, now: u64) {
        if self.given_up_until.is_some_and(|until| now < until) {
            return;
        }
        self.given_up_until = None;
        let per_mille = self.late * 1_000 / self.exchanges.max(1);
        if self.late <= CALM_MAX || per_mille <= CALM_PER_MILLE {
            self.raise_when_calm(now);
            return;
        }
        self.calm_since = None;
        if self.rate == FrameRate::Hz10 && per_mille * 10 > self.late_at_full * 7 {
            // So much less drawing has not made it a third better.
            self.rate = FrameRate::Full;
            self.given_up_until = Some(now + GIVEN_UP_FOR_US);
        } else if self.late >= LATE_MIN && per_mille > LATE_MAX_PER_MILLE {
            self.lower(now, per_mille);
        }
    }

    fn raise_when_calm(&mut self, now: u64) {
        if self
            .raised
            .is_some_and(|raised| now.saturating_sub(raised) >= TOO_SOON_US)
        {
            self.raised = None;
            self.raise_after = RAISE_AFTER_US;
        }
        let since = *self.calm_since.get_or_insert(now);
        if now.saturating_sub(since) >= self.raise_after
            && let Some(higher) = self.rate.higher()
        {
            self.rate = higher;
            self.raised = Some(now);
            self.calm_since = None;
        }
    }

    fn lower(&mut self, now: u64, late_per_mille: u32) {
        let too_soon = |raised: u64| now.saturating_sub(raised) < TOO_SOON_US;
        if self.raised.take().is_some_and(too_soon) {
            self.raise_after = (self.raise_after * 2).min(RAISE_AFTER_MAX_US);
        }
        if self.rate == FrameRate::Full {
            self.late_at_full = late_per_mille;
        }
        if let Some(lower) = self.rate.lower() {
            self.rate = lower;
        }
    }
}

#[cfg(test)]
#[path = "governor_tests.rs"]
mod tests;
