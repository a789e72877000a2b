//! Whether an angle follows from those before it.
//!
//! Bytes 6 and 7 of a reply to a query, read as those of a reply to a drive frame, are 2.8 degrees for each
//! degree of temperature, wherever the wheel stands. A wheel goes no further than its speed takes it: where
//! a reply may be one that was owed, an angle that jumps is not believed before the next says the same.

use motorlink_protocol::{Instant, Rpm};

/// Two readings of a wheel at rest differ by no more: a step of the coarse angle, and what a push gives.
const STEP_MAX_DEG: f32 = 10.0;
/// The report of the speed lags behind a wheel that is thrown or caught.
const SPEED_MARGIN: f32 = 1.5;

/// One reading.
#[derive(Clone, Copy, Debug)]
struct Read {
    at: Instant,
    degrees: f32,
    speed: Rpm,
}

impl Read {
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
pub(crate) struct Angles {
    believed: Option<Read>,
    doubted: Option<Read>,
}

impl Angles {
    /// Whether this reading is to be believed, beside the speed of the same reply. It is where it is
    /// `certain` what was asked.
    pub(crate) fn follows(&mut self, at: Instant, degrees: f32, speed: Rpm, certain: bool) -> bool {
        let read = Read { at, degrees, speed };
        let near = |before: Option<Read>| before.is_some_and(|before| before.leads_to(read));
        if certain || near(self.believed) || near(self.doubted) {
            self.believed = Some(read);
            self.doubted = None;
            true
        } else {
            self.doubted = Some(read);
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn follow(readings: &[(u64, f32, i16)], certain: bool) -> Vec<bool> {
        let mut angles = Angles::default();
        let at = |ms| Instant::ZERO + Duration::from_millis(ms);
        let follows = |(ms, degrees, rpm): &(u64, f32, i16)| {
            angles.follows(at(*ms), *degrees, Rpm::new(*rpm), certain)
        };
        readings.iter().map(follows).collect()
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
    fn where_nothing_was_ever_owed_every_angle_is_believed() {
        let by_hand = [(0, 0.0, 0), (100, 170.0, 0), (200, 340.0, 0)];
        assert_eq!(follow(&by_hand, true), [true, true, true]);
    }
}
