//! How fast a commanded speed may change.

use std::{fmt, time::Duration};

use motorlink_protocol::{Instant, Rpm, Setpoint, SpeedTarget};

/// The most that a commanded speed changes by in a second, 1-10,000 rpm.
///
/// It bounds what is sent in the velocity loop, beside the acceleration that the motor's own firmware
/// takes from the frame. It never bounds a stop: zero is sent as zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "u16", into = "u16"))]
pub struct Ramp(u16);

/// A ramp outside 1-10,000 rpm a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RampOutOfRange;

impl Ramp {
    /// Gentlest ramp in rpm a second.
    pub const MIN: u16 = 1;
    /// Steepest ramp in rpm a second: from standstill to full speed in two drive frames.
    pub const MAX: u16 = 10_000;

    /// A ramp in rpm a second.
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

    /// The most that a speed changes by in this time, in thousandths of an rpm.
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

impl fmt::Display for RampOutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a ramp goes from 1 to 10,000 rpm a second")
    }
}

impl std::error::Error for RampOutOfRange {}

/// The speed that was sent last, finer than the wire's whole rpm, so that a gentle ramp at a high rate
/// does not stand still.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ramped {
    at: Instant,
    milli_rpm: i64,
}

impl Ramped {
    /// A wheel that turns so fast, whoever turns it. What is not known counts as standstill: the ramp
    /// is longer then, not shorter.
    pub(crate) fn from(at: Instant, speed: Option<Rpm>) -> Self {
        let rpm = speed.map_or(0, |speed| i64::from(speed.rpm()));
        Self {
            at,
            milli_rpm: rpm * 1_000,
        }
    }

    /// What is sent now on the way to `goal`.
    pub(crate) fn step(&mut self, now: Instant, goal: Setpoint, ramp: Option<Ramp>) -> Setpoint {
        let Setpoint::Velocity {
            speed,
            acceleration,
        } = goal
        else {
            return goal;
        };
        let wanted = i64::from(speed.rpm()) * 1_000;
        let most = ramp.map_or(i64::MAX, |ramp| ramp.most_in(now.since(self.at)));
        let change = (wanted - self.milli_rpm).clamp(-most, most);
        self.at = now;
        // Zero is never waited for.
        self.milli_rpm = if wanted == 0 {
            0
        } else {
            self.milli_rpm + change
        };
        let rpm = i32::try_from(self.milli_rpm / 1_000).unwrap_or(0);
        Setpoint::Velocity {
            // A wheel may turn faster than it can be told to.
            speed: SpeedTarget::clamped(rpm),
            acceleration,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn a_speed_changes_by_the_ramp_and_no_faster_at_any_rate() {
        for period_ms in [2, 7, 20, 100] {
            let mut ramped = Ramped::from(at(0), None);
            let ramp = Some(Ramp::new(50).unwrap());
            for step in 1..=1_000 / period_ms {
                let sent = rpm(ramped.step(at(step * period_ms), goal(-200), ramp));
                let most = i64::try_from(step * period_ms * 50 / 1_000).unwrap();
                assert!(sent <= 0 && sent >= -most, "{sent} at {step}");
            }
            let after_a_second = ramped.step(at(1_000), goal(-200), ramp);
            assert_eq!(rpm(after_a_second), -50, "every {period_ms} ms");
        }
    }

    #[test]
    fn no_ramp_keeps_a_wheel_from_zero() {
        let mut ramped = Ramped::from(at(0), Some(Rpm::new(300)));
        let ramp = Some(Ramp::new(1).unwrap());
        assert_eq!(rpm(ramped.step(at(20), goal(0), ramp)), 0);
        assert_eq!(
            rpm(ramped.step(at(40), goal(300), ramp)),
            0,
            "and begins again there"
        );
    }

    #[test]
    fn a_ramp_begins_at_the_speed_of_the_wheel_and_passes_through_zero() {
        let mut ramped = Ramped::from(at(0), Some(Rpm::new(100)));
        let ramp = Some(Ramp::new(1_000).unwrap());
        let sent: Vec<i64> = (1..=10)
            .map(|step| rpm(ramped.step(at(step * 20), goal(-60), ramp)))
            .collect();
        assert_eq!(sent, [80, 60, 40, 20, 0, -20, -40, -60, -60, -60]);
    }

    #[test]
    fn without_a_ramp_and_in_other_loops_the_goal_is_sent() {
        let mut ramped = Ramped::from(at(0), None);
        assert_eq!(rpm(ramped.step(at(1), goal(330), None)), 330);
        let ramp = Some(Ramp::new(1).unwrap());
        assert_eq!(ramped.step(at(2), Setpoint::Brake, ramp), Setpoint::Brake);
    }

    #[test]
    fn a_ramp_is_in_range_or_none() {
        assert_eq!(Ramp::new(0), Err(RampOutOfRange));
        assert_eq!(Ramp::new(10_001), Err(RampOutOfRange));
        assert!(Ramp::new(1).is_ok() && Ramp::new(10_000).is_ok());
    }
}
