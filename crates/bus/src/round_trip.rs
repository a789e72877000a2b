//! Round trips on this adapter, and the reply window that follows from them.

use std::{mem, time::Duration};

use crate::timing::{FIRST_WINDOW, MAX_WINDOW, MIN_WINDOW};

/// Samples kept for the statistics: with fewer, the 99th percentile would be chance.
const KEPT: usize = 256;

/// Upper ends of the bins of [`RoundTripStatus::histogram`], in microseconds; the last bin has
/// none. An exchange takes at least 1.7 ms on the wire; an FTDI adapter adds 16 ms.
pub const ROUND_TRIP_BINS_US: [u32; 11] = [
    2_000, 2_500, 3_000, 4_000, 5_000, 6_500, 8_000, 10_000, 14_000, 18_000, 25_000,
];

/// Round trips of the last 256 replies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoundTripStatus {
    /// From the first byte of a request to the last of its reply, in microseconds; `None` before the
    /// first reply.
    pub median_us: Option<u32>,
    /// 99th percentile, in microseconds.
    pub p99_us: Option<u32>,
    /// Replies per bin; the bins end at [`ROUND_TRIP_BINS_US`].
    pub histogram: [u16; ROUND_TRIP_BINS_US.len() + 1],
}

/// Round-trip statistics by the estimator of TCP (RFC 6298): a smoothed mean and deviation.
#[derive(Clone, Debug)]
pub(crate) struct RoundTrip {
    smoothed_us: u32,
    deviation_us: u32,
    /// The last samples, in the order in which they came.
    kept: [u32; KEPT],
    /// The same ones, the shortest first: statuses are asked for far more often than replies come.
    sorted: Vec<u32>,
    count: usize,
    /// The fastest of the last complete [`KEPT`] samples, and of those since.
    fastest_us: [u32; 2],
    /// Requests in a row without a reply.
    lost: u32,
}

impl RoundTrip {
    pub(crate) const fn new() -> Self {
        Self {
            smoothed_us: 0,
            deviation_us: 0,
            kept: [0; KEPT],
            sorted: Vec::new(),
            count: 0,
            fastest_us: [u32::MAX; 2],
            lost: 0,
        }
    }

    pub(crate) fn replied(&mut self, took: Duration) {
        let sample = u32::try_from(took.as_micros()).unwrap_or(u32::MAX);
        if self.count == 0 {
            self.smoothed_us = sample;
            self.deviation_us = sample / 2;
        } else {
            self.deviation_us = mix(self.deviation_us, self.smoothed_us.abs_diff(sample), 4);
            self.smoothed_us = mix(self.smoothed_us, sample, 8);
        }
        let place = self.count % KEPT;
        if let Some(slot) = self.kept.get_mut(place) {
            let oldest = mem::replace(slot, sample);
            if self.count >= KEPT {
                let place = self.sorted.partition_point(|kept| *kept < oldest);
                self.sorted.remove(place);
            }
            let place = self.sorted.partition_point(|kept| *kept < sample);
            self.sorted.insert(place, sample);
        }
        let [earlier, newest] = self.fastest_us;
        self.fastest_us = if place == 0 {
            [newest, sample]
        } else {
            [earlier, newest.min(sample)]
        };
        self.count += 1;
        self.lost = 0;
    }

    pub(crate) fn lost(&mut self) {
        self.lost = self.lost.saturating_add(1);
    }

    /// Reply window; `None` before the first reply.
    pub(crate) fn window(&self) -> Option<Duration> {
        if self.count == 0 {
            return None;
        }
        // Four deviations as in the RFC, and never less than the scheduling delay of a busy
        // browser.
        let spread = Duration::from_micros(u64::from(self.deviation_us) * 4).max(MIN_WINDOW / 2);
        let window = Duration::from_micros(self.smoothed_us.into()) + spread;
        Some(window.clamp(MIN_WINDOW, MAX_WINDOW))
    }

    /// How often the window is doubled: once for every third loss in a row, since a lost reply may
    /// be late. One or two losses are chance, and a longer window would cost drive frames.
    pub(crate) fn doublings(&self) -> u32 {
        (self.lost / 3).min(3)
    }

    /// Usual round trip; [`FIRST_WINDOW`] before the first reply.
    pub(crate) fn usual(&self) -> Duration {
        if self.count == 0 {
            FIRST_WINDOW
        } else {
            Duration::from_micros(self.smoothed_us.into())
        }
    }

    /// Fastest of the last 256 to 512 samples; `None` before the first reply.
    pub(crate) fn fastest(&self) -> Option<Duration> {
        let [earlier, newest] = self.fastest_us;
        (self.count > 0).then(|| Duration::from_micros(earlier.min(newest).into()))
    }

    /// Smoothed round trip; `None` before the first reply.
    pub(crate) fn measured(&self) -> Option<Duration> {
        (self.count > 0).then(|| Duration::from_micros(self.smoothed_us.into()))
    }

    pub(crate) fn median_us(&self) -> Option<u32> {
        self.sorted.get(self.sorted.len() / 2).copied()
    }

    pub(crate) fn status(&self) -> RoundTripStatus {
        let mut histogram = [0_u16; ROUND_TRIP_BINS_US.len() + 1];
        for took in &self.sorted {
            let class = ROUND_TRIP_BINS_US.partition_point(|end| end <= took);
            if let Some(count) = histogram.get_mut(class) {
                *count += 1;
            }
        }
        RoundTripStatus {
            median_us: self.median_us(),
            p99_us: self.sorted.get(self.sorted.len() * 99 / 100).copied(),
            histogram,
        }
    }
}

/// Exponential moving average: one `weight`th of the sample is new.
fn mix(mean: u32, sample: u32, weight: u32) -> u32 {
    let mixed = (u64::from(mean) * u64::from(weight - 1) + u64::from(sample)) / u64::from(weight);
    u32::try_from(mixed).unwrap_or(u32::MAX)
}
