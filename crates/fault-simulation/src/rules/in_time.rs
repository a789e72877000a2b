//! Whether replies come in their windows on a line whose adapter is slow and does nothing else wrong.

use std::time::Duration;

use motorlink_bus::Bus;
use motorlink_protocol::Instant;

use crate::{
    action::LineFault,
    rule::{Rule, Violation, broken},
};

/// So long after the last disturbance the windows fit the adapter.
const FITS_AFTER: Duration = Duration::from_secs(2);
/// Then replies are counted for so long.
const COUNTED_FOR: Duration = Duration::from_secs(1);
/// Fewer requests tell nothing.
const ASKED_MIN: u64 = 10;
/// With more motors each of them answers too rarely to be measured in that time.
const MOTORS_MAX: usize = 4;
/// With more, request and reply take nearly as long as the longest window of 40 ms.
const HOLD_MAX_MS: u8 = 30;

/// Late replies on an undisturbed line.
#[derive(Debug, Default)]
pub(super) struct InTime {
    line_is_slow_at_most: bool,
    undisturbed_since: Option<Instant>,
    /// Requests and late replies of all motors when the count began.
    before: Option<(Instant, u64, u64)>,
}

impl InTime {
    /// The line was set healthy or faulty; `None` if it carries nothing.
    pub(super) fn line(&mut self, line: Option<LineFault>) {
        self.line_is_slow_at_most = match line {
            Some(LineFault::None | LineFault::Holds) => true,
            Some(LineFault::Gathers(ms)) => ms <= HOLD_MAX_MS,
            _ => false,
        };
        self.disturbed();
    }

    /// A frame, a reply or a call was lost or late.
    pub(super) const fn disturbed(&mut self) {
        self.undisturbed_since = None;
        self.before = None;
    }

    /// All events of this moment are out. Returns whether a count was judged.
    pub(super) fn settled(&mut self, now: Instant, bus: &Bus) -> Result<bool, Violation> {
        let answer = bus.motors(now).all(|status| !status.is_silent());
        // A stop and a job have windows of their own, and a person may send what nobody answers.
        let is_plain = bus.job().is_none() && !bus.is_stopping() && bus.raw().is_none();
        let few = bus.motors(now).count() <= MOTORS_MAX;
        if !(self.line_is_slow_at_most && answer && is_plain && few) {
            self.disturbed();
            return Ok(false);
        }
        let since = *self.undisturbed_since.get_or_insert(now);
        if now.since(since) < FITS_AFTER {
            return Ok(false);
        }
        let (mut asked, mut late) = (0, 0);
        for status in bus.motors(now) {
            asked += status.counters.requests;
            late += status.counters.late;
        }
        let (began, asked_before, late_before) = *self.before.get_or_insert((now, asked, late));
        if now.since(began) < COUNTED_FOR {
            return Ok(false);
        }
        self.before = None;
        let (asked, late) = (asked - asked_before, late - late_before);
        if asked < ASKED_MIN {
            return Ok(false);
        }
        if late * 10 > asked {
            let what = format!("{late} of {asked} replies were late since {began:?}");
            return broken(Rule::RepliesInTime, now, what);
        }
        Ok(true)
    }
}
