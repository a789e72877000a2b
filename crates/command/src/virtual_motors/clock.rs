//! The one clock of the program.

use motorlink_protocol::Instant;
use rustix::time::{ClockId, Timespec, clock_gettime};

/// `CLOCK_MONOTONIC`, which other programs of the same machine can compare with.
pub(crate) fn now() -> Instant {
    let Timespec { tv_sec, tv_nsec } = clock_gettime(ClockId::Monotonic);
    let seconds = u64::try_from(tv_sec).unwrap_or(0);
    let nanos = u64::try_from(tv_nsec).unwrap_or(0);
    Instant::from_micros(seconds.saturating_mul(1_000_000) + nanos / 1000)
}

/// What `poll` takes as the time to wait until `at`.
pub(crate) fn until(at: Instant, now: Instant) -> Timespec {
    let wait = at.since(now);
    Timespec {
        tv_sec: i64::try_from(wait.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: wait.subsec_nanos().into(),
    }
}
