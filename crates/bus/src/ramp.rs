//! The ramp: how fast a commanded speed may grow.

use std::time::Duration;

use motorlink_protocol::{Instant, Rpm, Setpoint, SpeedTarget};

/// Largest growth of the magnitude of a commanded speed per second, 1-10,000 rpm.
///
/// It limits the velocity loop, in addition to the acceleration of the motor's firmware. It limits
/// growth only: a lower speed, zero and the brake are sent at once, so no wheel is driven faster
/// than asked or in the other direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "u16", into = "u16"))]
pub struct Ramp(u16);

/// A ramp outside 1-10,000 rpm per second.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a ramp goes from 1 to 10,000 rpm a second")]
pub struct RampOutOfRange;

impl Ramp {
    /// Slowest ramp in rpm per second.
    pub const MIN: u16 = 1;
    /// Steepest ramp in rpm per second: from standstill to full speed in two drive frames.
    pub const MAX: u16 = 10_000;

    /// A ramp in rpm per second.
    ///
    /// # Errors
    /// Outside 1..=10,000.
    pub const fn new(rpm_a_second: u16) -> Result<Self, RampOutOfRange> {
        if rpm_a_second < Self::MIN || rpm_a_second > Self::MAX {
            Err(RampOutOfRange)
        } else {
            Ok(Self(rpm_a_second))
        }
    }

    /// Largest change of speed in this time, in thousandths of an rpm.
    fn most_in(self, time: Duration) -> i64 {
        let micros = i64::try_from(time.as_micros()).unwrap_or(i64::MAX);
        i64::from(self.0).saturating_mul(micros) / 1_000
    }
}

impl TryFrom<u16> for Ramp {
    type Error = RampOutOfRange;

    fn try_from(rpm_a_second: u16) -> Result<Self, Self::Error> {
        Self::new(rpm_a_second)
    }
}

impl From<Ramp> for u16 {
    fn from(ramp: Ramp) -> Self {
        ramp.0
    }
}

/// The longest pause between frames that one step of the ramp covers. A longer pause must not make
/// a wheel jump.
const CAUGHT_UP_MAX: Duration = Duration::from_millis(100);

/// The speed that was sent last, finer than the whole rpm of the wire, so that a slow ramp at a
/// high rate advances.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ramped {
    at: Instant,
    milli_rpm: i64,
}

impl Ramped {
    /// Starts from the speed of a reply of the last 500 ms, or from zero if the speed is unknown:
    /// the longest ramp.
    pub(crate) fn from(at: Instant, speed: Option<Rpm>) -> Self {
        let rpm = speed.map_or(0, |speed| i64::from(speed.rpm()));
        Self {
            at,
            milli_rpm: rpm * 1_000,
        }
    }

    /// The setpoint to send now on the way to `goal`.
    pub(crate) fn step(
        &mut self,
        now: Instant,
        goal: Setpoint,
        ramp: Option<Ramp>,
        period: Duration,
    ) -> Setpoint {
        let elapsed = now.since(self.at).min(period.max(CAUGHT_UP_MAX));
        self.at = now;
        let Setpoint::Velocity {
            speed,
            acceleration,
        } = goal
        else {
            self.milli_rpm = 0;
            return goal;
        };
        let wanted = i64::from(speed.rpm()) * 1_000;
        let same_way = wanted.signum() == self.milli_rpm.signum();
        let reached = if same_way { self.milli_rpm.abs() } else { 0 };
        let most = ramp.map_or(i64::MAX, |ramp| {
            reached.saturating_add(ramp.most_in(elapsed))
        });
        self.milli_rpm = wanted.signum() * wanted.abs().min(most);
        let rpm = i32::try_from(self.milli_rpm / 1_000).unwrap_or(0);
        Setpoint::Velocity {
            speed: SpeedTarget::clamped(rpm),
            acceleration,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: Duration = Duration::from_millis(20);

    fn rpm(setpoint: Setpoint) -> i64 {
        let Setpoint::Velocity { speed, .. } = setpoint else {
            panic!("{setpoint:?}");
        };
        speed.rpm().into()
    }

    fn goal(rpm: i32) -> Setpoint {
        Setpoint::velocity(SpeedTarget::new(rpm).unwrap())
    }

    fn at(ms: u64) -> Instant {
        Instant::from_millis(ms)
    }

    fn ramp(rpm_a_second: u16) -> Option<Ramp> {
        Ramp::new(rpm_a_second).ok()
    }

    /// What is sent every 20 ms.
    fn sent(ramped: &mut Ramped, from_ms: u64, goal: Setpoint, ramp: Option<Ramp>) -> Vec<i64> {
        let steps = (1..=6).map(|step| at(from_ms + step * 20));
        steps
            .map(|now| rpm(ramped.step(now, goal, ramp, PERIOD)))
            .collect()
    }

    #[test]
    fn a_speed_grows_by_the_ramp_and_no_faster_at_any_rate() {
        for period_ms in [2, 7, 20, 100] {
            let period = Duration::from_millis(period_ms);
            let mut ramped = Ramped::from(at(0), None);
            for step in 1..=1_000 / period_ms {
                let now = at(step * period_ms);
                let sent = rpm(ramped.step(now, goal(-200), ramp(50), period));
                let most = i64::try_from(step * period_ms * 50 / 1_000).unwrap();
                assert!(sent <= 0 && sent >= -most, "{sent} at {step}");
            }
            let after_a_second = ramped.step(at(1_000), goal(-200), ramp(50), period);
            assert_eq!(rpm(after_a_second), -50, "every {period_ms} ms");
        }
    }

    #[test]
    fn a_slower_speed_zero_and_brake_are_sent_at_once() {
        let mut ramped = Ramped::from(at(0), Some(Rpm::new(300)));
        assert_eq!(rpm(ramped.step(at(20), goal(5), ramp(1), PERIOD)), 5);
        assert_eq!(rpm(ramped.step(at(40), goal(0), ramp(1), PERIOD)), 0);
        let brake = ramped.step(at(60), Setpoint::Brake, ramp(1), PERIOD);
        assert_eq!(brake, Setpoint::Brake);
        // And the way up begins at zero again, however long it stood.
        let sent = ramped.step(at(30_000), goal(300), ramp(50), PERIOD);
        assert_eq!(rpm(sent), 5);
    }

    #[test]
    fn no_wheel_is_driven_beyond_its_goal_or_the_other_way() {
        let mut ramped = Ramped::from(at(0), Some(Rpm::new(-200)));
        let up = sent(&mut ramped, 0, goal(60), ramp(1_000));
        assert_eq!(up, [20, 40, 60, 60, 60, 60]);
        let down = sent(&mut ramped, 120, goal(-60), ramp(1_000));
        assert_eq!(down, [-20, -40, -60, -60, -60, -60]);
    }

    #[test]
    fn a_pause_of_the_frames_is_not_caught_up_at_once() {
        let mut ramped = Ramped::from(at(0), None);
        let sent = ramped.step(at(5_000), goal(300), ramp(100), PERIOD);
        assert_eq!(rpm(sent), 10);
    }

    #[test]
    fn without_a_ramp_the_goal_is_sent() {
        let mut ramped = Ramped::from(at(0), None);
        assert_eq!(rpm(ramped.step(at(1), goal(330), None, PERIOD)), 330);
        assert_eq!(rpm(ramped.step(at(2), goal(-330), None, PERIOD)), -330);
    }

    #[test]
    fn a_ramp_is_in_range_or_none() {
        assert_eq!(Ramp::new(0), Err(RampOutOfRange));
        assert_eq!(Ramp::new(10_001), Err(RampOutOfRange));
        assert!(Ramp::new(1).is_ok() && Ramp::new(10_000).is_ok());
    }
}
