//! Use of the line's time.

use std::time::Duration;

use motorlink_protocol::{Frame, Instant, Request, family::Model};

use crate::{
    counters::Counters,
    last_second::{LastSecond, OVER_US},
    rate::RateMeter,
    round_trip::RoundTripStatus,
};

/// Use and quality of the line, over all motors.
///
/// The shares cover the last second, in per mille. The rest to 1,000 is idle time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LineStatus {
    /// The model of all motors on the line.
    pub model: Model,
    /// Whether a motor has answered as this model. Before that nothing drives.
    pub model_known: bool,
    /// Answered exchanges per second, over the last second.
    pub exchanges_hz: u16,
    /// Drive and stop frames with their replies, per mille.
    pub drive_per_mille: u16,
    /// Feedback queries with their replies, per mille.
    pub query_per_mille: u16,
    /// All other frames, per mille: mode switches, ID queries, set ID, raw frames.
    pub other_per_mille: u16,
    /// Reply windows without a reply, per mille.
    pub waiting_per_mille: u16,
    /// Calls of the bus and replies per second that came over 1 ms late: calls after the moment that
    /// [`crate::Output::Wait`] named, replies after the fastest of the last ones of that motor. A machine that is too busy
    /// causes both; an adapter that holds bytes causes the second.
    pub late_hz: u16,
    /// Round trips.
    pub round_trip: RoundTripStatus,
    /// Drive frames per second of each driven motor, if the line cannot carry the command rate for
    /// all; else `None`.
    pub carries_hz: Option<u16>,
    /// Counters of exchanges with no single motor as addressee.
    pub unaddressed: Counters,
}

/// What the line was used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    Drive,
    Query,
    Other,
    Waiting,
}

impl Use {
    /// The use of a request that was answered or expects no answer.
    pub(crate) fn of(frame: &Frame) -> Self {
        match Request::parse(frame) {
            Ok(Request::Drive { .. }) => Self::Drive,
            Ok(Request::Query { .. }) => Self::Query,
            // The mode query of separate frames.
            Err(_) if frame.bytes()[1] == 0x75 => Self::Query,
            _ => Self::Other,
        }
    }
}

const USES: usize = 4;

/// Sums the use of the line.
#[derive(Clone, Debug, Default)]
pub(crate) struct LineUse {
    /// Microseconds of each use.
    used: LastSecond<[u32; USES]>,
    exchanges: RateMeter,
}

impl LineUse {
    /// Adds a use that ended now.
    pub(crate) fn add(&mut self, now: Instant, what: Use, took: Duration) {
        if let Some(share) = self.used.now(now).get_mut(what as usize) {
            let micros = u32::try_from(took.as_micros()).unwrap_or(u32::MAX);
            *share = share.saturating_add(micros);
        }
        if what != Use::Waiting {
            self.exchanges.count(now);
        }
    }

    /// Answered exchanges per second.
    pub(crate) fn exchanges_hz(&self, now: Instant) -> u16 {
        self.exchanges.hertz(now)
    }

    /// Shares of the last second, in per mille: drive, query, other, waiting.
    pub(crate) fn shares(&self, now: Instant) -> [u16; USES] {
        let mut sums = [0_u32; USES];
        for slot in self.used.over(now) {
            for (sum, share) in sums.iter_mut().zip(slot) {
                *sum = sum.saturating_add(share);
            }
        }
        sums.map(|sum| {
            let per_mille = u64::from(sum) * 1_000 / OVER_US;
            // An exchange counts in the slot in which it ends, so a share may come out slightly
            // high.
            u16::try_from(per_mille.min(1_000)).unwrap_or(1_000)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_of_the_last_second_and_vanish_with_it() {
        let mut line = LineUse::default();
        let mut now = Instant::from_millis(5_000);
        for step in 0..200_u64 {
            now = now + Duration::from_millis(10);
            let what = if step % 2 == 0 {
                Use::Drive
            } else {
                Use::Query
            };
            line.add(now, what, Duration::from_millis(4));
        }
        let [drive, query, other, waiting] = line.shares(now);
        assert!((190..=210).contains(&drive) && (190..=210).contains(&query));
        assert_eq!((other, waiting), (0, 0));
        assert!((98..=102).contains(&line.exchanges_hz(now)));
        assert_eq!(line.shares(now + Duration::from_secs(1)), [0; 4]);
    }

    #[test]
    fn waiting_is_no_exchange() {
        let mut line = LineUse::default();
        let now = Instant::from_millis(950);
        line.add(now, Use::Waiting, Duration::from_millis(90));
        let later = now + Duration::from_millis(100);
        assert_eq!(line.shares(later), [0, 0, 0, 100]);
        assert_eq!(line.exchanges_hz(later), 0);
    }
}
