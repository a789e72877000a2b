//! Outlier filter for the angle.
//!
//! Bytes 6 and 7 of a query reply, read as those of a drive reply, give 2.8 degrees per degree of
//! temperature, wherever the wheel stands. A wheel turns no further than its speed allows. So while
//! a reply may answer an earlier request, an angle that jumps needs a second reading that confirms
//! it.

use motorlink_protocol::{Instant, Rpm};

/// Largest difference of two readings of a wheel at rest: one step of the coarse angle, and the
/// effect of a push.
const STEP_MAX_DEG: f32 = 10.0;
/// The reported speed lags behind a wheel that is pushed or stopped by hand.
const SPEED_MARGIN: f32 = 1.5;

/// One reading.
#[derive(Clone, Copy, Debug)]
struct Reading {
    at: Instant,
    degrees: f32,
    speed: Rpm,
}

impl Reading {
    fn leads_to(self, next: Self) -> bool {
        let apart = (next.degrees - self.degrees + 180.0).rem_euclid(360.0) - 180.0;
        let fastest = self.speed.degrees_per_second().abs();
        let fastest = fastest.max(next.speed.degrees_per_second().abs());
        let turned = fastest * SPEED_MARGIN * next.at.since(self.at).as_secs_f32();
        apart.abs() <= STEP_MAX_DEG + turned
    }
}

/// The last readings of one motor.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AngleFilter {
    accepted: Option<Reading>,
    candidate: Option<Reading>,
}

impl AngleFilter {
    /// Whether to accept this reading, given the speed in the same reply. A reading is accepted if
    /// its request is `certain`.
    pub(crate) fn accepts(&mut self, at: Instant, degrees: f32, speed: Rpm, certain: bool) -> bool {
        let read = Reading { at, degrees, speed };
        let near = |before: Option<Reading>| before.is_some_and(|before| before.leads_to(read));
        if certain || near(self.accepted) || near(self.candidate) {
            self.accepted = Some(read);
            self.candidate = None;
            true
        } else {
            self.candidate = Some(read);
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn follow(readings: &[(u64, f32, i16)], certain: bool) -> Vec<bool> {
        let mut angle_filter = AngleFilter::default();
        let at = |ms| Instant::ZERO + Duration::from_millis(ms);
        let accepts = |(ms, degrees, rpm): &(u64, f32, i16)| {
            angle_filter.accepts(at(*ms), *degrees, Rpm::new(*rpm), certain)
        };
        readings.iter().map(accepts).collect()
    }

    #[test]
    fn a_wheel_goes_where_its_speed_takes_it() {
        let turning = [(0, 350.0, 100), (20, 2.0, 100), (40, 14.0, 100)];
        assert_eq!(follow(&turning, false), [false, true, true]);
        let braked = [(0, 0.0, 200), (1, 0.0, 200), (101, 60.0, 0)];
        assert_eq!(follow(&braked, false), [false, true, true]);
    }

    #[test]
    fn a_single_jump_is_not_believed_and_one_that_stays_is() {
        let jump = [(0, 0.0, 0), (20, 0.5, 0), (40, 78.8, 0), (60, 0.0, 0)];
        assert_eq!(follow(&jump, false), [false, true, false, true]);
        let moved = [(0, 0.0, 0), (1, 0.0, 0), (500, 90.0, 0), (520, 91.0, 0)];
        assert_eq!(follow(&moved, false), [false, true, false, true]);
    }

    #[test]
    fn where_no_reply_was_ever_missing_every_angle_is_believed() {
        let by_hand = [(0, 0.0, 0), (100, 170.0, 0), (200, 340.0, 0)];
        assert_eq!(follow(&by_hand, true), [true, true, true]);
    }
}
