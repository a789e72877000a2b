//! The speed of a wheel by its odometry replies.

use std::time::Duration;

use motorlink_protocol::{Instant, Position, Rpm};

/// Between two replies further apart than this the speed may have changed.
const APART_MAX: Duration = Duration::from_secs(1);
/// No wheel is as fast, whatever turns it. A motor that has got its power back counts its turns from zero.
const SPEED_MAX_RPM: f32 = 10_000.0;

/// The last odometry reply of a motor.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LastOdometry(Option<Reported>);

#[derive(Clone, Copy, Debug)]
struct Reported {
    at: Instant,
    /// When the motor measured, if that is certain.
    measured: Option<Instant>,
    part: f32,
    turns: i32,
}

impl LastOdometry {
    /// The mean speed since the last reply, rounded away from zero: a wheel that has moved at all is not reported
    /// to stand. `None` without an earlier reply, or if it is uncertain when the motor `measured` one of them.
    ///
    /// The sign is that of a growing angle. No source says whether the angle grows at positive speed, so the
    /// size is what counts.
    pub(crate) fn speed(
        &mut self,
        now: Instant,
        measured: Option<Instant>,
        turns: i32,
        position: Position,
    ) -> Option<Rpm> {
        let part = f32::from(position.raw()) / 32_768.0;
        let before = self.0.replace(Reported {
            at: now,
            measured,
            part,
            turns,
        })?;
        let passed = measured?.since(before.measured?);
        if passed > APART_MAX || passed.is_zero() {
            return None;
        }
        #[allow(
            clippy::cast_precision_loss,
            reason = "a wheel makes few turns between two replies"
        )]
        let moved = turns.wrapping_sub(before.turns) as f32 + part - before.part;
        let rpm = moved / passed.as_secs_f32() * 60.0;
        if rpm.abs() > SPEED_MAX_RPM {
            return None;
        }
        // The angle itself jitters by a step or two.
        let rpm = if rpm.abs() < 0.2 { 0.0 } else { rpm };
        #[allow(clippy::cast_possible_truncation, reason = "ten thousand fit")]
        let whole = (if rpm < 0.0 { rpm.floor() } else { rpm.ceil() }) as i16;
        Some(Rpm::new(whole))
    }

    /// Whether the wheel is more than half a turn from the zero of its odometry. An old report does not count.
    pub(crate) fn is_far_from_zero(&self, now: Instant) -> bool {
        #[allow(
            clippy::cast_precision_loss,
            reason = "only a small number of turns is near zero"
        )]
        let turns = |last: Reported| last.turns as f32 + last.part;
        let last = self.0.filter(|last| now.since(last.at) <= APART_MAX);
        last.map(turns).is_some_and(|turns| turns.abs() > 0.5)
    }

    pub(crate) fn forget(&mut self) {
        self.0 = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: u64) -> Instant {
        Instant::ZERO + Duration::from_millis(ms)
    }

    #[test]
    fn the_speed_is_counted_across_full_turns() {
        let mut last = LastOdometry::default();
        let mut speed = |ms, turns, raw| {
            let position = Position::from_raw(raw);
            last.speed(at(ms), Some(at(ms)), turns, position)
        };
        assert_eq!(speed(0, 4, 30_000), None);
        // A tenth of a turn in 100 ms is 60 rpm.
        assert_eq!(speed(100, 5, 508), Some(Rpm::new(60)));
        assert_eq!(speed(200, 4, 30_000), Some(Rpm::new(-60)));
        assert_eq!(speed(300, 4, 30_000), Some(Rpm::new(0)));
        assert_eq!(speed(400, 4, 30_030), Some(Rpm::new(1)));
        assert_eq!(speed(2_000, 4, 0), None);
    }

    #[test]
    fn a_motor_that_counts_its_turns_from_zero_again_tells_no_speed() {
        let mut last = LastOdometry::default();
        let mut speed = |ms, turns| {
            let position = Position::from_raw(100);
            last.speed(at(ms), Some(at(ms)), turns, position)
        };
        assert_eq!(speed(0, -300), None);
        assert_eq!(speed(165, 0), None);
        assert_eq!(speed(265, 0), Some(Rpm::new(0)));
    }

    #[test]
    fn a_reply_of_an_uncertain_time_tells_no_speed_and_neither_does_the_next() {
        let mut last = LastOdometry::default();
        let mut speed = |ms, measured| last.speed(at(ms), measured, 1, Position::from_raw(0));
        assert_eq!(speed(0, Some(at(0))), None);
        assert_eq!(speed(100, None), None);
        assert_eq!(speed(200, Some(at(200))), None);
        assert_eq!(speed(300, Some(at(300))), Some(Rpm::new(0)));
        assert!(last.is_far_from_zero(at(300)));
    }
}
