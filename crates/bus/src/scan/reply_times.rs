//! How long replies take during a full scan, and the window that follows from it.

use std::{collections::VecDeque, time::Duration};

use crate::{
    round_trip::RoundTrip,
    timing::{FIRST_WINDOW, SCAN_MARGIN, SCAN_WINDOW_MAX},
};

/// The reply window follows from the second slowest of this many last replies: one reply delayed by
/// a busy machine does not lengthen every later window. A reply after its window arrives in the
/// next one and counts too.
const RECENT: usize = 16;

/// The round trips of a scan.
#[derive(Clone, Debug)]
pub(super) struct ReplyTimes {
    /// Round trips on this adapter, including those before the scan.
    round_trip: RoundTrip,
    /// The last round trips of the scan, newest last.
    recent: VecDeque<Duration>,
}

impl ReplyTimes {
    pub(super) fn new(round_trip: RoundTrip) -> Self {
        Self {
            round_trip,
            recent: VecDeque::with_capacity(RECENT),
        }
    }

    /// The usual round trip on this adapter.
    pub(super) fn usual(&self) -> Duration {
        self.round_trip.usual()
    }

    /// Reply window of a probe.
    pub(super) fn window(&self) -> Duration {
        let measured = self.round_trip.window().unwrap_or(FIRST_WINDOW);
        // The estimator starts with a wide spread, which 254 windows make expensive.
        let slowest = self.slowest_but_one().map(|slowest| slowest + SCAN_MARGIN);
        slowest
            .map_or(measured, |slowest| measured.min(slowest))
            .min(SCAN_WINDOW_MAX)
    }

    /// The second slowest of the last replies, or the only one.
    fn slowest_but_one(&self) -> Option<Duration> {
        let (mut slowest, mut next) = (None, None);
        for took in self.recent.iter().copied().map(Some) {
            next = next.max(slowest.min(took));
            slowest = slowest.max(took);
        }
        next.or(slowest)
    }

    /// Adds the round trip of a reply.
    pub(super) fn add(&mut self, took: Duration) {
        self.round_trip.replied(took);
        if self.recent.len() == RECENT {
            self.recent.pop_front();
        }
        self.recent.push_back(took);
    }
}
