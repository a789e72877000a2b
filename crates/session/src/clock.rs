//! Converts between both clocks of a session.

use motorlink_protocol::Instant;

/// Nanoseconds since 1970 at a time of the monotonic clock; `zero_unix_us` is the wall clock at [`Instant::ZERO`]. A
/// time before 1970 gives 1970.
pub(crate) fn utc_ns(zero_unix_us: i64, at: Instant) -> u64 {
    let ns = (i128::from(zero_unix_us) + i128::from(at.as_micros())) * 1_000;
    u64::try_from(ns.max(0)).unwrap_or(u64::MAX)
}

/// The wall clock at [`Instant::ZERO`], in microseconds since 1970, from one time on both clocks.
pub(crate) fn zero_unix_us(at: Instant, utc_ns: u64) -> i64 {
    let us = i128::from(utc_ns / 1_000) - i128::from(at.as_micros());
    i64::try_from(us).unwrap_or_default()
}
