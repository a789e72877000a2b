//! The wire comes first: where drawing delays frames or replies, the page draws less often.
//!
//! On a machine without a GPU the browser draws on the cores that the port worker needs. The bus counts what is
//! late ([`LineStatus::late_hz`]). The governor looks at it once a second and lowers the frame rate until the wire
//! is on time. Where that does not help, drawing is not the cause, and the page draws as before.

use std::time::Duration;

use motorlink_messages::{bus::LineStatus, protocol::Instant};

use crate::ui::frame_rate::FrameRate;

/// The bus counts over the last second.
const LOOK_EVERY: Duration = Duration::from_secs(1);
/// With fewer exchanges a second nothing is driven at a rate that drawing could disturb.
const EXCHANGES_MIN_HZ: u16 = 20;
/// More of the exchanges late than this: the rate goes down.
const LATE_MAX_PER_MILLE: u32 = 40;
/// Fewer late than this, for a while: the rate goes up.
const CALM_PER_MILLE: u32 = 15;
/// How long the wire is on time before the rate goes up. Twice as long after each time that was too soon.
const RAISE_AFTER: Duration = Duration::from_secs(5);
const RAISE_AFTER_MAX: Duration = Duration::from_secs(80);
/// A rate that has to be lowered so soon after it was raised was raised too soon.
const TOO_SOON: Duration = Duration::from_secs(10);
/// How long the page draws as before where drawing less did not help.
const GIVEN_UP_FOR: Duration = Duration::from_secs(60);

/// Decides the frame rate from what is late on the wire.
#[derive(Clone, Debug)]
pub(crate) struct Governor {
    rate: FrameRate,
    looked: Instant,
    /// Late exchanges, per mille, when the rate was last lowered from the full one.
    late_at_full: u32,
    calm_since: Option<Instant>,
    raised: Option<Instant>,
    raise_after: Duration,
    given_up_until: Option<Instant>,
}

impl Default for Governor {
    fn default() -> Self {
        Self {
            rate: FrameRate::Full,
            looked: Instant::default(),
            late_at_full: 0,
            calm_since: None,
            raised: None,
            raise_after: RAISE_AFTER,
            given_up_until: None,
        }
    }
}

impl Governor {
    /// The frame rate from now on. `line` is `None` while no port is open.
    pub(crate) fn look(&mut self, now: Instant, line: Option<&LineStatus>) -> FrameRate {
        let Some(line) = line else {
            *self = Self {
                looked: now,
                ..Self::default()
            };
            return self.rate;
        };
        if line.exchanges_hz < EXCHANGES_MIN_HZ {
            // Whatever is driven next begins with the rate that was right for the last.
            self.looked = now;
            return FrameRate::Full;
        }
        if now.since(self.looked) >= LOOK_EVERY {
            self.looked = now;
            let late = u32::from(line.late_hz) * 1_000 / u32::from(line.exchanges_hz);
            self.judge(now, late);
        }
        self.rate
    }

    fn judge(&mut self, now: Instant, late_per_mille: u32) {
        if self.given_up_until.is_some_and(|until| now < until) {
            return;
        }
        self.given_up_until = None;
        if late_per_mille > LATE_MAX_PER_MILLE {
            self.calm_since = None;
            self.lower(now, late_per_mille);
        } else if late_per_mille > CALM_PER_MILLE {
            self.calm_since = None;
        } else {
            let since = *self.calm_since.get_or_insert(now);
            if now.since(since) >= self.raise_after
                && let Some(higher) = self.rate.higher()
            {
                self.rate = higher;
                self.raised = Some(now);
                self.calm_since = None;
            }
        }
    }

    fn lower(&mut self, now: Instant, late_per_mille: u32) {
        let too_soon = |raised: Instant| now.since(raised) < TOO_SOON;
        if self.raised.take().is_some_and(too_soon) {
            self.raise_after = (self.raise_after * 2).min(RAISE_AFTER_MAX);
        }
        if self.rate == FrameRate::Full {
            self.late_at_full = late_per_mille;
        }
        if let Some(lower) = self.rate.lower() {
            self.rate = lower;
        } else if late_per_mille * 10 > self.late_at_full * 7 {
            // Six times less drawing has not made it a third better.
            self.rate = FrameRate::Full;
            self.given_up_until = Some(now + GIVEN_UP_FOR);
        }
    }
}

#[cfg(test)]
#[path = "governor_tests.rs"]
mod tests;
