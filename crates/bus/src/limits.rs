//! What a person lets a driven motor reach before it is stopped.

use std::{fmt, time::Duration};

use motorlink_protocol::{Celsius, Current, Instant, Rpm, Setpoint};

use crate::Sample;

/// A wheel overshoots the speed that it is asked for by so much: one at its limit is not to be stopped
/// for that. 5 % of the motor's own no-load speed.
const OVERSHOOT_RPM: u16 = 10;

/// A current above its limit is let pass for so long: a wheel that starts draws more for a moment.
pub const OVERCURRENT_FOR: Duration = Duration::from_millis(500);

/// The highest speed, current and temperature at which a driven motor is left driven.
///
/// | limit | at first | allowed | crossed |
/// |---|---|---|---|
/// | speed | 330 rpm | 1-330 rpm | by one reply over 10 rpm above it |
/// | current | 2.7 A, the stall current | 0.1-8 A | by every reply of half a second |
/// | temperature | 75 deg C | 30-80 deg C | by one reply that reports it |
///
/// The motor protects itself at 80 deg C (`motor.md`); a higher limit would never be reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[u16; 3]", into = "[u16; 3]"))]
pub struct Limits {
    speed_rpm: u16,
    current_ma: u16,
    temperature_c: u16,
}

/// A limit outside the table of [`Limits`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LimitOutOfRange;

/// The limit that was crossed, and what the motor reported then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Crossed {
    /// It turned too fast.
    Speed {
        /// As it reported.
        reached: Rpm,
        /// In rpm.
        limit: u16,
    },
    /// It drew too much for half a second.
    Current {
        /// As it reported last.
        reached: Current,
        /// In mA.
        limit: u16,
    },
    /// It was too hot.
    Temperature {
        /// As it reported.
        reached: Celsius,
        /// In deg C.
        limit: u16,
    },
}

impl Limits {
    /// Lowest and highest speed limit in rpm.
    pub const SPEED_RPM: (u16, u16) = (1, 330);
    /// Lowest and highest current limit in mA; the highest is full scale.
    pub const CURRENT_MA: (u16, u16) = (100, 8_000);
    /// Lowest and highest temperature limit in deg C.
    pub const TEMPERATURE_C: (u16, u16) = (30, 80);

    /// Limits in rpm, mA and deg C.
    ///
    /// # Errors
    /// One of them is outside its range.
    pub const fn new(
        speed_rpm: u16,
        current_ma: u16,
        temperature_c: u16,
    ) -> Result<Self, LimitOutOfRange> {
        if is_within(speed_rpm, Self::SPEED_RPM)
            && is_within(current_ma, Self::CURRENT_MA)
            && is_within(temperature_c, Self::TEMPERATURE_C)
        {
            Ok(Self {
                speed_rpm,
                current_ma,
                temperature_c,
            })
        } else {
            Err(LimitOutOfRange)
        }
    }

    /// In rpm.
    #[must_use]
    pub const fn speed_rpm(self) -> u16 {
        self.speed_rpm
    }

    /// In mA.
    #[must_use]
    pub const fn current_ma(self) -> u16 {
        self.current_ma
    }

    /// In deg C.
    #[must_use]
    pub const fn temperature_c(self) -> u16 {
        self.temperature_c
    }

    /// Whether a motor may be asked for this at all.
    #[must_use]
    pub const fn allow(self, setpoint: Setpoint) -> bool {
        match setpoint {
            Setpoint::Velocity { speed, .. } => speed.rpm().unsigned_abs() <= self.speed_rpm,
            // What it draws is another thing than what it is asked for, and a moment is allowed.
            Setpoint::Current(_) | Setpoint::Position(_) | Setpoint::Brake => true,
        }
    }

    const fn is_over_current(self, current: Current) -> bool {
        let milliamps = current.raw().unsigned_abs() as u32 * 8_000 / 32_767;
        milliamps > self.current_ma as u32
    }

    /// Which of them a motor has crossed that is driven since `driven_since`, by its last reply and a
    /// temperature that is no older than it may be.
    pub(crate) fn crossed(
        self,
        last: Sample,
        temperature: Option<Celsius>,
        overcurrent: Overcurrent,
        driven_since: Instant,
    ) -> Option<Crossed> {
        let (speed, current) = (last.reply.speed, last.reply.current);
        if last.at >= driven_since && speed.magnitude() > self.speed_rpm + OVERSHOOT_RPM {
            return Some(Crossed::Speed {
                reached: speed,
                limit: self.speed_rpm,
            });
        }
        if overcurrent.lasted(last.at, driven_since) >= OVERCURRENT_FOR {
            return Some(Crossed::Current {
                reached: current,
                limit: self.current_ma,
            });
        }
        self.too_hot(temperature)
    }

    /// Whether a motor is too hot to be driven.
    pub(crate) fn too_hot(self, temperature: Option<Celsius>) -> Option<Crossed> {
        let reached = temperature?;
        let is_over = u16::from(reached.degrees()) > self.temperature_c;
        is_over.then_some(Crossed::Temperature {
            reached,
            limit: self.temperature_c,
        })
    }
}

const fn is_within(value: u16, (least, most): (u16, u16)) -> bool {
    value >= least && value <= most
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            speed_rpm: 330,
            current_ma: 2_700,
            temperature_c: 75,
        }
    }
}

impl TryFrom<[u16; 3]> for Limits {
    type Error = LimitOutOfRange;

    fn try_from([speed_rpm, current_ma, temperature_c]: [u16; 3]) -> Result<Self, Self::Error> {
        Self::new(speed_rpm, current_ma, temperature_c)
    }
}

impl From<Limits> for [u16; 3] {
    fn from(limits: Limits) -> Self {
        [limits.speed_rpm, limits.current_ma, limits.temperature_c]
    }
}

impl fmt::Display for LimitOutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("limits go from 1 to 330 rpm, from 0.1 to 8 A and from 30 to 80 °C")
    }
}

impl std::error::Error for LimitOutOfRange {}

impl fmt::Display for Crossed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // Without a sign, which a mirrored motor has the other way round.
            Self::Speed { reached, limit } => {
                let reached = reached.magnitude();
                write!(f, "{reached} rpm, above your limit of {limit} rpm")
            }
            Self::Current { reached, limit } => {
                let (reached, limit) = (reached.scaled(), Milliamps(*limit));
                write!(f, "{reached} A, above your limit of {limit} A")
            }
            Self::Temperature { reached, limit } => {
                let reached = reached.degrees();
                write!(f, "{reached} °C, above your limit of {limit} °C")
            }
        }
    }
}

/// As amps, to a tenth where that is all.
struct Milliamps(u16);

impl fmt::Display for Milliamps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (amps, rest) = (self.0 / 1_000, self.0 % 1_000);
        if rest % 100 == 0 {
            write!(f, "{amps}.{}", rest / 100)
        } else {
            write!(f, "{amps}.{rest:03}")
        }
    }
}

/// Since when every reply of a motor has reported a current above its limit.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Overcurrent(Option<Instant>);

impl Overcurrent {
    pub(crate) fn heard(&mut self, sample: Sample, limits: Limits) {
        self.0 = if limits.is_over_current(sample.reply.current) {
            self.0.or(Some(sample.at))
        } else {
            None
        };
    }

    /// Up to a reply, of a motor that is driven since `driven_since`.
    fn lasted(self, until: Instant, driven_since: Instant) -> Duration {
        self.0
            .map_or(Duration::ZERO, |since| until.since(since.max(driven_since)))
    }
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{Detail, Faults, Mode, MotorId, Reply, SpeedTarget};

    use super::*;

    fn sample(at_ms: u64, rpm: i16, amps: f32) -> Sample {
        Sample {
            at: Instant::from_millis(at_ms),
            reply: Reply {
                id: MotorId::FIRST,
                mode: Mode::Velocity,
                current: Current::from_amps(amps),
                speed: Rpm::new(rpm),
                detail: Detail::Undetermined([0, 0]),
                faults: Faults::NONE,
            },
        }
    }

    fn crossed(limits: Limits, samples: &[Sample], celsius: Option<u8>) -> Option<Crossed> {
        let mut over = Overcurrent::default();
        for sample in samples {
            over.heard(*sample, limits);
        }
        let last = *samples.last().unwrap();
        limits.crossed(last, celsius.map(Celsius::new), over, Instant::ZERO)
    }

    #[test]
    fn a_speed_is_crossed_beyond_what_a_wheel_overshoots() {
        let limits = Limits::new(100, 2_700, 75).unwrap();
        for rpm in [0, 100, -100, 110, -110] {
            assert_eq!(crossed(limits, &[sample(1, rpm, 0.1)], None), None);
        }
        for rpm in [111, -111, i16::MIN] {
            let crossed = crossed(limits, &[sample(1, rpm, 0.1)], None);
            assert!(matches!(crossed, Some(Crossed::Speed { limit: 100, .. })));
        }
    }

    #[test]
    fn a_current_is_crossed_by_every_reply_of_half_a_second() {
        let limits = Limits::default();
        let at = |ms, amps| sample(ms, 0, amps);
        let short = [at(0, 2.8), at(499, -5.0)];
        assert_eq!(crossed(limits, &short, None), None);
        let broken = [at(0, 2.8), at(300, 2.6), at(700, 2.8)];
        assert_eq!(crossed(limits, &broken, None), None);
        let long = [at(0, 2.8), at(300, -2.8), at(500, 2.75)];
        let words = crossed(limits, &long, None).unwrap().to_string();
        assert_eq!(words, "2.750 A, above your limit of 2.7 A");
    }

    #[test]
    fn what_it_drew_before_it_was_driven_is_not_counted() {
        let (limits, mut over) = (Limits::default(), Overcurrent::default());
        for ms in [0, 400, 800] {
            over.heard(sample(ms, 0, 3.0), limits);
        }
        let last = sample(800, 0, 3.0);
        let since = |ms| limits.crossed(last, None, over, Instant::from_millis(ms));
        assert_eq!(since(301), None);
        assert!(since(300).is_some());
    }

    #[test]
    fn a_temperature_is_crossed_above_its_limit_and_unknown_is_not_hot() {
        let cool = [sample(1, 0, 0.0)];
        assert_eq!(crossed(Limits::default(), &cool, None), None);
        assert_eq!(crossed(Limits::default(), &cool, Some(75)), None);
        let hot = crossed(Limits::default(), &cool, Some(76)).unwrap();
        assert_eq!(hot.to_string(), "76 °C, above your limit of 75 °C");
    }

    #[test]
    fn limits_lie_within_what_the_motor_takes() {
        assert_eq!(Limits::new(330, 2_700, 75), Ok(Limits::default()));
        for (speed, current, temperature) in [
            (0, 2_700, 75),
            (331, 2_700, 75),
            (330, 99, 75),
            (330, 8_001, 75),
            (330, 2_700, 29),
            (330, 2_700, 81),
        ] {
            assert!(Limits::new(speed, current, temperature).is_err());
        }
    }

    #[test]
    fn only_a_speed_is_refused_before_it_is_reached() {
        let limits = Limits::new(100, 100, 30).unwrap();
        let speed = |rpm| Setpoint::velocity(SpeedTarget::clamped(rpm));
        assert!(
            limits.allow(speed(100)) && limits.allow(speed(-100)) && limits.allow(Setpoint::Brake)
        );
        assert!(!limits.allow(speed(101)) && !limits.allow(speed(-330)));
    }
}
