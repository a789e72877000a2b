//! One motor in the overview.

use motorlink_protocol::{Celsius, Current, Faults, Reply, Rpm};

/// The summary of one motor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotorOverview {
    /// Frames sent to it.
    pub sent: u64,
    /// Valid replies.
    pub replies: u64,
    /// Requests without a reply.
    pub lost: u64,
    /// Every fault that it reported.
    pub faults: Faults,
    /// The highest temperature, in degrees Celsius.
    pub temperature_max_c: Option<u8>,
    pub(super) buckets: Vec<Option<Extent>>,
}

/// Least and greatest values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Least and greatest speed.
    pub speed: (Rpm, Rpm),
    /// Least and greatest current; `None` if no reply has one.
    pub current: Option<(Current, Current)>,
}

impl Extent {
    /// `None` for a reply without a speed.
    fn of(reply: &Reply) -> Option<Self> {
        let speed = reply.speed?;
        Some(Self {
            speed: (speed, speed),
            current: reply.current.map(|current| (current, current)),
        })
    }

    fn and(self, other: Self) -> Self {
        let (a, b) = (self, other);
        Self {
            speed: (a.speed.0.min(b.speed.0), a.speed.1.max(b.speed.1)),
            current: match (a.current, b.current) {
                (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
                (one, other) => one.or(other),
            },
        }
    }

    fn joined(one: Option<Self>, other: Option<Self>) -> Option<Self> {
        match (one, other) {
            (Some(one), Some(other)) => Some(one.and(other)),
            (one, other) => one.or(other),
        }
    }
}

impl MotorOverview {
    pub(super) fn replied(&mut self, bucket: usize, reply: &Reply) {
        self.faults = self.faults.joined(reply.faults);
        let temperature = reply.detail.temperature().map(Celsius::degrees);
        self.temperature_max_c = self.temperature_max_c.max(temperature);
        if self.buckets.len() <= bucket {
            self.buckets.resize(bucket + 1, None);
        }
        if let Some(slot) = self.buckets.get_mut(bucket) {
            *slot = Extent::joined(*slot, Extent::of(reply));
        }
    }

    pub(super) fn double_buckets(&mut self) {
        let pairs = self.buckets.chunks(2);
        self.buckets = pairs
            .map(|pair| pair.iter().copied().fold(None, Extent::joined))
            .collect();
    }

    /// Least and greatest values of each bucket; `None` if it has no reply. There are no buckets after the last
    /// reply.
    #[must_use]
    pub fn buckets(&self) -> &[Option<Extent>] {
        &self.buckets
    }

    /// Least and greatest values of the whole session; `None` without a reply.
    #[must_use]
    pub fn extent(&self) -> Option<Extent> {
        self.buckets.iter().copied().fold(None, Extent::joined)
    }
}
