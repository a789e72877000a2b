//! Moments: microseconds since an epoch, and arithmetic that saturates.

use std::time::Duration;

use motorlink_protocol::Instant;

const LAST: Instant = Instant::from_micros(u64::MAX);

#[test]
fn a_moment_is_its_microseconds() {
    assert_eq!(Instant::ZERO.as_micros(), 0);
    assert_eq!(Instant::from_micros(1_234_567).as_micros(), 1_234_567);
    assert_eq!(Instant::from_millis(1_234).as_micros(), 1_234_000);
    assert_eq!(
        format!("{:?}", Instant::from_micros(1_034_567)),
        "1.034567 s"
    );
}

#[test]
fn a_duration_is_added_and_subtracted_exactly() {
    let (from, by) = (Instant::from_micros(5_000), Duration::from_micros(1_999));
    assert_eq!((from + by).as_micros(), 6_999);
    assert_eq!((from - by).as_micros(), 3_001);
    assert_eq!((from + by).since(from), by);
    assert_eq!(from.since(from + by), Duration::ZERO);
}

#[test]
fn arithmetic_ends_at_the_first_and_the_last_moment() {
    assert_eq!(Instant::from_millis(u64::MAX), LAST);
    assert_eq!(Instant::from_millis(1) + Duration::MAX, LAST);
    assert_eq!(Instant::from_millis(1) - Duration::MAX, Instant::ZERO);
}
