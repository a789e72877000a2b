//! Whether a temperature follows from those before it.
//!
//! Bytes 6 and 7 of a reply to a drive frame, read as those of a reply to a query, are any temperature at
//! all. A motor is a kilogram of metal: what jumps is no temperature of it. One that jumps is not believed
//! before the next says the same.

use motorlink_protocol::{Celsius, Instant};

/// Two readings of one temperature differ by no more: a step of the sensor up and one down, and one spare.
const STEP_MAX_C: f32 = 3.0;
/// Three times the rate of the simulated motor where it stands under its stall current.
const RATE_MAX_C_PER_S: f32 = 3.0;

/// The last readings of one motor.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Temperatures {
    believed: Option<(Instant, Celsius)>,
    doubted: Option<(Instant, Celsius)>,
}

impl Temperatures {
    /// Whether this reading is to be believed. The first is where it is `certain` that it is one.
    pub(crate) fn follows(&mut self, at: Instant, read: Celsius, certain: bool) -> bool {
        let near = |before: Option<(Instant, Celsius)>| {
            before.is_some_and(|(then, before)| {
                let step = f32::from(read.degrees()) - f32::from(before.degrees());
                step.abs() <= STEP_MAX_C + RATE_MAX_C_PER_S * at.since(then).as_secs_f32()
            })
        };
        let first = self.believed.is_none() && certain;
        if first || near(self.believed) || near(self.doubted) {
            self.believed = Some((at, read));
            self.doubted = None;
            true
        } else {
            self.doubted = Some((at, read));
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn follow(readings: &[(u64, u8)], certain: bool) -> Vec<bool> {
        let mut temperatures = Temperatures::default();
        let at = |ms| Instant::ZERO + Duration::from_millis(ms);
        let follows =
            |(ms, read): &(u64, u8)| temperatures.follows(at(*ms), Celsius::new(*read), certain);
        readings.iter().map(follows).collect()
    }

    #[test]
    fn what_grows_as_a_motor_does_is_believed() {
        let growing: Vec<_> = (0..100_u8)
            .map(|s| (u64::from(s) * 1_000, 25 + s))
            .collect();
        assert!(follow(&growing, true).iter().all(|it| *it));
        assert!(
            follow(&[(0, 25), (100, 28), (200, 25)], true)
                .iter()
                .all(|it| *it)
        );
    }

    #[test]
    fn a_single_jump_is_not_and_one_that_stays_is() {
        let jump = [(0, 28), (100, 113), (200, 28), (300, 0), (400, 28)];
        assert_eq!(follow(&jump, true), [true, false, true, false, true]);
        assert_eq!(
            follow(&[(0, 28), (100, 80), (200, 81)], true),
            [true, false, true]
        );
    }

    #[test]
    fn after_a_long_time_it_may_be_anything_that_can_have_come() {
        assert_eq!(follow(&[(0, 60), (15_000, 25)], true), [true, true]);
    }

    #[test]
    fn the_first_is_doubted_where_something_was_owed() {
        assert_eq!(
            follow(&[(0, 0), (100, 28), (200, 28)], false),
            [false, false, true]
        );
    }
}
