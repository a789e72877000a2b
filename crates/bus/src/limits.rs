//! The operator's limits for driven motors.

use std::{fmt, time::Duration};

use motorlink_protocol::{Celsius, Current, Instant, Rpm, Setpoint};

use crate::sample::Sample;

/// A wheel overshoots its setpoint by this much. A wheel at its limit must not be stopped for that.
/// 5 % of the motor's own no-load speed.
const OVERSHOOT_RPM: u16 = 10;

/// A current above its limit is tolerated for this long: a starting wheel draws more for a moment.
pub const OVERCURRENT_FOR: Duration = Duration::from_millis(500);

/// Highest speed, current and temperature of a driven motor.
///
/// | limit | at first | allowed | exceeded |
/// |---|---|---|---|
/// | speed | 330 rpm | 1-380 rpm | by one reply over 10 rpm above it |
/// | current | 2.7 A, the stall current | 0.1-8 A | by every reply of half a second |
/// | temperature | 75 deg C | 30-80 deg C | by one reply that reports it |
///
/// The highest speed is that of the fastest model; the first one is that of a DDSM115.
/// The motor protects itself at 80 deg C (`motor.md`); a higher limit would have no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[u16; 3]", into = "[u16; 3]"))]
pub struct Limits {
    speed_rpm: u16,
    current_ma: u16,
    temperature_c: u16,
}

/// A limit outside the table of [`Limits`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("limits go from 1 to 380 rpm, from 0.1 to 8 A and from 30 to 80 °C")]
pub struct LimitOutOfRange;

/// An exceeded limit, and the value that the motor reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ExceededLimit {
    /// Too fast.
    // Without a sign: a mirrored motor has the opposite one.
    #[error("{} rpm, above your limit of {limit} rpm", .reached.magnitude())]
    Speed {
        /// Reported value.
        reached: Rpm,
        /// In rpm.
        limit: u16,
    },
    /// Too much current for half a second.
    #[error("{} A, above your limit of {} A", .reached.scaled(), Milliamps(*.limit))]
    Current {
        /// Last reported value.
        reached: Current,
        /// In mA.
        limit: u16,
    },
    /// Too hot.
    #[error("{} °C, above your limit of {limit} °C", .reached.degrees())]
    Temperature {
        /// Reported value.
        reached: Celsius,
        /// In deg C.
        limit: u16,
    },
}

impl Limits {
    /// Lowest and highest speed limit in rpm.
    pub const SPEED_RPM: (u16, u16) = (1, 380);
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

    /// Whether the limits allow this setpoint.
    #[must_use]
    pub const fn allow(self, setpoint: Setpoint) -> bool {
        match setpoint {
            Setpoint::Velocity { speed, .. } => speed.rpm().unsigned_abs() <= self.speed_rpm,
            // The drawn current differs from the setpoint, and a short excess is tolerated.
            Setpoint::Current(_)
            | Setpoint::OpenLoop(_)
            | Setpoint::Position(_)
            | Setpoint::Brake => true,
        }
    }

    const fn is_over_current(self, current: Current) -> bool {
        let milliamps = current.raw().unsigned_abs() as u32 * 8_000 / 32_767;
        milliamps > self.current_ma as u32
    }

    /// The limit that a motor has exceeded since `driven_since`, by its last reply and a fresh
    /// temperature.
    pub(crate) fn exceeded(
        self,
        last: Sample,
        temperature: Option<Celsius>,
        overcurrent: Overcurrent,
        driven_since: Instant,
    ) -> Option<ExceededLimit> {
        if let Some(reached) = last.reply.speed
            && last.at >= driven_since
            && reached.magnitude() > self.speed_rpm + OVERSHOOT_RPM
        {
            return Some(ExceededLimit::Speed {
                reached,
                limit: self.speed_rpm,
            });
        }
        if let Some(reached) = overcurrent.since_long(driven_since) {
            return Some(ExceededLimit::Current {
                reached,
                limit: self.current_ma,
            });
        }
        self.too_hot(temperature)
    }

    /// The limit that an active setpoint exceeds: the operator may have lowered it.
    pub(crate) fn exceeded_by(self, setpoint: Setpoint) -> Option<ExceededLimit> {
        match setpoint {
            Setpoint::Velocity { speed, .. } if !self.allow(setpoint) => {
                Some(ExceededLimit::Speed {
                    reached: Rpm::new(speed.rpm()),
                    limit: self.speed_rpm,
                })
            }
            _ => None,
        }
    }

    /// Whether a motor is too hot to be driven.
    pub(crate) fn too_hot(self, temperature: Option<Celsius>) -> Option<ExceededLimit> {
        let reached = temperature?;
        let is_over = u16::from(reached.degrees()) > self.temperature_c;
        is_over.then_some(ExceededLimit::Temperature {
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

/// In amps, with one decimal if that is exact.
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

/// The replies in a row that report a current above the limit: the time of the first, and the last with its time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Overcurrent(Option<(Instant, (Instant, Current))>);

impl Overcurrent {
    /// Records a sample. One without a current neither begins nor ends an overcurrent.
    pub(crate) fn record(&mut self, sample: Sample, limits: Limits) {
        let Some(current) = sample.reply.current else {
            return;
        };
        let since = self.0.map_or(sample.at, |(since, _)| since);
        self.0 = limits
            .is_over_current(current)
            .then_some((since, (sample.at, current)));
    }

    /// The last current, if the overcurrent of a motor driven since `driven_since` has lasted too long.
    fn since_long(self, driven_since: Instant) -> Option<Current> {
        let (since, (until, reached)) = self.0?;
        let lasted = until.since(since.max(driven_since));
        (lasted >= OVERCURRENT_FOR).then_some(reached)
    }
}

#[cfg(test)]
#[path = "limits_tests.rs"]
mod tests;
