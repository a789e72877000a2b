//! The speed of a wheel by its odometry replies.

use std::time::Duration;

use motorlink_protocol::{Instant, Position, Rpm};

/// Between two replies further apart than this the speed may have changed.
const APART_MAX: Duration = Duration::from_secs(1);

/// The last odometry reply of a motor.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LastOdometry(Option<(Instant, f32, i32)>);

impl LastOdometry {
    /// The mean speed since the last reply, rounded away from zero: a wheel that has moved at all is not reported
    /// to stand. `None` without an earlier reply.
    ///
    /// The sign is that of a growing angle. No source says whether the angle grows at positive speed, so the
    /// size is what counts.
    pub(crate) fn speed(&mut self, now: Instant, turns: i32, position: Position) -> Option<Rpm> {
        let part = f32::from(position.raw()) / 32_768.0;
        let (at, part_before, turns_before) = self.0.replace((now, part, turns))?;
        let passed = now.since(at);
        if passed > APART_MAX || passed.is_zero() {
            return None;
        }
        #[allow(
            clippy::cast_precision_loss,
            reason = "a wheel makes few turns between two replies"
        )]
        let moved = turns.wrapping_sub(turns_before) as f32 + part - part_before;
        let rpm = moved / passed.as_secs_f32() * 60.0;
        // The angle itself jitters by a step or two.
        let rpm = if rpm.abs() < 0.2 { 0.0 } else { rpm };
        #[allow(
            clippy::cast_possible_truncation,
            reason = "a float cast saturates, which is what is meant"
        )]
        let whole = (if rpm < 0.0 { rpm.floor() } else { rpm.ceil() }) as i16;
        Some(Rpm::new(whole))
    }

    /// Whether the wheel is more than half a turn from the zero of its odometry. An old report does not count.
    pub(crate) fn is_far_from_zero(&self, now: Instant) -> bool {
        #[allow(
            clippy::cast_precision_loss,
            reason = "only a small number of turns is near zero"
        )]
        let turns = |(_, part, turns): (Instant, f32, i32)| turns as f32 + part;
        let last = self.0.filter(|(at, ..)| now.since(*at) <= APART_MAX);
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
        let position = Position::from_raw;
        assert_eq!(last.speed(at(0), 4, position(30_000)), None);
        // A tenth of a turn in 100 ms is 60 rpm.
        assert_eq!(last.speed(at(100), 5, position(508)), Some(Rpm::new(60)));
        assert_eq!(
            last.speed(at(200), 4, position(30_000)),
            Some(Rpm::new(-60))
        );
        assert_eq!(last.speed(at(300), 4, position(30_000)), Some(Rpm::new(0)));
        assert_eq!(last.speed(at(400), 4, position(30_030)), Some(Rpm::new(1)));
        assert_eq!(last.speed(at(2_000), 4, position(0)), None);
    }
}
