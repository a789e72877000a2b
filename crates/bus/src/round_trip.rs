//! How long an exchange takes on this adapter, and so how long to wait for a reply.

use std::time::Duration;

use crate::timing::{FIRST_WINDOW, MAX_WINDOW, MIN_WINDOW};

/// Samples kept for the median that the page shows.
const KEPT: usize = 64;

/// Round-trip statistics by the estimator of TCP (RFC 6298): a smoothed mean and deviation.
#[derive(Clone, Debug)]
pub(crate) struct RoundTrip {
    smoothed_us: u32,
    deviation_us: u32,
    kept: [u32; KEPT],
    count: usize,
    /// Requests in a row without a reply.
    lost: u32,
}

impl RoundTrip {
    pub(crate) const fn new() -> Self {
        Self {
            smoothed_us: 0,
            deviation_us: 0,
            kept: [0; KEPT],
            count: 0,
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
        if let Some(slot) = self.kept.get_mut(self.count % KEPT) {
            *slot = sample;
        }
        self.count += 1;
        self.lost = 0;
    }

    pub(crate) fn lost(&mut self) {
        self.lost = self.lost.saturating_add(1);
    }

    /// How long to wait for a reply before the line is free again; `None` before the first reply.
    pub(crate) fn window(&self) -> Option<Duration> {
        if self.count == 0 {
            return None;
        }
        // Four deviations as in the RFC, and never less than a busy browser's hiccup.
        let spread = Duration::from_micros(u64::from(self.deviation_us) * 4).max(MIN_WINDOW / 2);
        let window = Duration::from_micros(self.smoothed_us.into()) + spread;
        Some(window.clamp(MIN_WINDOW, MAX_WINDOW))
    }

    /// How often the window is doubled: once for every third loss in a row, since what seems lost may
    /// be late. One or two are bad luck, and a longer wait would cost a motor drive frames.
    pub(crate) fn doublings(&self) -> u32 {
        (self.lost / 3).min(3)
    }

    /// How long an exchange that is answered usually takes.
    pub(crate) fn usual(&self) -> Duration {
        if self.count == 0 {
            FIRST_WINDOW
        } else {
            Duration::from_micros(self.smoothed_us.into())
        }
    }

    pub(crate) fn median_us(&self) -> Option<u32> {
        let mut sorted = self.kept;
        let samples = sorted.get_mut(..self.count.min(KEPT))?;
        samples.sort_unstable();
        samples.get(samples.len() / 2).copied()
    }
}

/// The old mean with one `weight`th of the sample.
fn mix(mean: u32, sample: u32, weight: u32) -> u32 {
    let mixed = (u64::from(mean) * u64::from(weight - 1) + u64::from(sample)) / u64::from(weight);
    u32::try_from(mixed).unwrap_or(u32::MAX)
}
