//! Outlier filter for the temperature.
//!
//! Bytes 6 and 7 of a drive reply, read as those of a query reply, give any temperature. A motor is
//! a kilogram of metal: its temperature cannot jump. A value that jumps needs a second reading that
//! confirms it.

use motorlink_protocol::{Celsius, Instant};

/// Largest difference of two readings at constant temperature: one step of the sensor each way, and
/// one spare.
const STEP_MAX_C: f32 = 3.0;
/// Three times the heating rate of the simulated motor at its stall current.
const RATE_MAX_C_PER_S: f32 = 3.0;

/// The last readings of one motor.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TemperatureFilter {
    accepted: Option<(Instant, Celsius)>,
    candidate: Option<(Instant, Celsius)>,
}

impl TemperatureFilter {
    /// Whether to accept this reading. The first is accepted if its request is `certain`.
    pub(crate) fn accepts(&mut self, at: Instant, read: Celsius, certain: bool) -> bool {
        let near = |before: Option<(Instant, Celsius)>| {
            before.is_some_and(|(then, before)| {
                let step = f32::from(read.degrees()) - f32::from(before.degrees());
                step.abs() <= STEP_MAX_C + RATE_MAX_C_PER_S * at.since(then).as_secs_f32()
            })
        };
        let first = self.accepted.is_none() && certain;
        if first || near(self.accepted) || near(self.candidate) {
            self.accepted = Some((at, read));
            self.candidate = None;
            true
        } else {
            self.candidate = Some((at, read));
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn follow(readings: &[(u64, u8)], certain: bool) -> Vec<bool> {
        let mut temperature_filter = TemperatureFilter::default();
        let at = |ms| Instant::ZERO + Duration::from_millis(ms);
        let accepts = |(ms, read): &(u64, u8)| {
            temperature_filter.accepts(at(*ms), Celsius::new(*read), certain)
        };
        readings.iter().map(accepts).collect()
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
    fn the_first_is_doubted_where_a_reply_is_missing() {
        assert_eq!(
            follow(&[(0, 0), (100, 28), (200, 28)], false),
            [false, false, true]
        );
    }
}
