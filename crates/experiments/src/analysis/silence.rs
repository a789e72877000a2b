//! What a motor did when its drive frames ceased: decided from its speed and current over time.

use strum::{EnumString, IntoStaticStr};

use super::Point;

/// What a motor does when drive frames cease.
#[derive(Clone, Copy, Debug, PartialEq, Eq, EnumString, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum WhenSilent {
    /// It keeps its last command, for as long as was measured.
    Keeps,
    /// No current flows, and the wheel runs down.
    Coasts,
    /// A current slows the wheel down.
    Brakes,
}

/// A motor in a time without drive frames. Speeds and currents are without direction, times in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Silence<'a> {
    /// Its speed before, in rpm.
    pub before: &'a [Point],
    /// Its speed meanwhile, in rpm.
    pub speed: &'a [Point],
    /// Its current meanwhile, in A; empty if the replies do not tell it.
    pub amps: &'a [Point],
    /// When it ended.
    pub to_s: f64,
}

/// Without this speed there is nothing to keep: the wheel was blocked, or the motor did not obey.
const TURNS_RPM: f64 = 20.0;
/// A velocity loop holds its speed within a rpm (captures at 100 rpm: 99 to 100). A wheel that has lost more than this part
/// is not driven: without current a free wheel loses 100 rpm in about 0.1 s, so 5 % of 30 rpm in 1.5 ms.
const KEPT: f64 = 0.95;
/// Below this part of its speed a fall is over.
const FALLEN: f64 = 0.1;
/// A free wheel without current loses 100 rpm in about 0.1 s. Twice as fast is a brake, whatever the current says.
const BRAKE_RPM_S: f64 = 2_000.0;
/// The brake takes 120 rpm in about 250 ms, so 27 of 30 rpm in 0.12 s. Where no current is known, half as fast is no
/// brake.
const COAST_RPM_S: f64 = 100.0;
/// A free wheel needs about 0.07 A to turn. Less than half of it is none.
const NO_CURRENT_A: f64 = 0.035;
/// The speed at the end is the median of this time.
const END_S: f64 = 0.15;
/// Fewer points in a silence, or at its end, tell nothing.
const POINTS_MIN: usize = 10;
const END_POINTS_MIN: usize = 3;

/// The median of the values; `None` without values.
pub(crate) fn median(points: &[Point]) -> Option<f64> {
    super::spread(points.iter().map(|point| point.value)).map(|spread| spread.median)
}

impl WhenSilent {
    /// Its name in a file.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.into()
    }

    /// The one with this name.
    #[must_use]
    pub fn from_key(key: &str) -> Option<Self> {
        key.parse().ok()
    }
}

impl Silence<'_> {
    /// What the motor did; `None` if too few replies came, or if the wheel did not turn before.
    #[must_use]
    pub fn verdict(&self) -> Option<WhenSilent> {
        let before = self.speed_before()?;
        if self.speed.len() < POINTS_MIN {
            return None;
        }
        if keeps(before, self.speed_at_end()?) {
            return Some(WhenSilent::Keeps);
        }
        let high = |point: &&Point| point.value >= KEPT * before;
        let driven = self.before.iter().chain(self.speed);
        let high_s = driven.rev().find(high)?.t_s;
        let later = || self.speed.iter().filter(|point| point.t_s > high_s);
        let low = later().find(|point| point.value <= FALLEN * before);
        let low = low.or_else(|| later().next_back())?;
        let fell_rpm_s = (before - low.value) / (low.t_s - high_s).max(f64::EPSILON);
        if fell_rpm_s >= BRAKE_RPM_S {
            return Some(WhenSilent::Brakes);
        }
        let falling = |point: &&Point| point.t_s > high_s && point.t_s < low.t_s;
        if !self.speed.iter().any(|point| falling(&point)) {
            // The replies of the fall are lost.
            return None;
        }
        let (sum, count) = self
            .amps
            .iter()
            .filter(falling)
            .fold((0.0, 0.0), |(sum, count), point| {
                (sum + point.value, count + 1.0)
            });
        let brakes = if count > 0.0 {
            sum / count >= NO_CURRENT_A
        } else {
            fell_rpm_s >= COAST_RPM_S
        };
        Some(if brakes {
            WhenSilent::Brakes
        } else {
            WhenSilent::Coasts
        })
    }

    /// The speed before, if the wheel turned.
    #[must_use]
    pub fn speed_before(&self) -> Option<f64> {
        median(self.before).filter(|rpm| *rpm >= TURNS_RPM)
    }

    /// The speed at the end.
    #[must_use]
    pub fn speed_at_end(&self) -> Option<f64> {
        let from_s = self.to_s - END_S;
        let first = self.speed.partition_point(|point| point.t_s < from_s);
        let last = self.speed.get(first..)?;
        median(last).filter(|_| last.len() >= END_POINTS_MIN)
    }
}

/// Whether a wheel at this speed is still driven.
pub(crate) fn keeps(before: f64, after: f64) -> bool {
    after >= KEPT * before
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wheel at 30 rpm whose speed follows `rpm` from 0.1 s on, and which draws `amps` while it slows down. It is
    /// asked every 5 ms, but for the times that are `lost`.
    fn verdict(
        rpm: impl Fn(f64) -> f64,
        amps: Option<f64>,
        lost: impl Fn(f64) -> bool,
    ) -> Option<WhenSilent> {
        let times = |from: i32, to: i32| (from..to).map(|step| f64::from(step) * 0.005);
        let at = |t_s: f64| {
            if t_s < 0.1 {
                30.0
            } else {
                rpm(t_s - 0.1).max(0.0)
            }
        };
        let before: Vec<Point> = times(-100, 0).map(|t_s| Point::new(t_s, 30.0)).collect();
        let heard: Vec<f64> = times(0, 120).filter(|t_s| !lost(*t_s)).collect();
        let speed: Vec<Point> = heard
            .iter()
            .map(|t_s| Point::new(*t_s, at(*t_s).round()))
            .collect();
        let current = |t_s: &f64| Some(Point::new(*t_s, amps?));
        let silence = Silence {
            before: &before,
            speed: &speed,
            amps: &heard.iter().filter_map(current).collect::<Vec<_>>(),
            to_s: 0.6,
        };
        silence.verdict()
    }

    #[test]
    fn speed_and_current_tell_a_wheel_that_coasts_from_one_that_brakes() {
        use WhenSilent::{Brakes, Coasts, Keeps};
        let even = |_: f64| 30.0;
        let by = |rpm_s: f64| move |t_s: f64| 30.0 - rpm_s * t_s;
        let none = |_: f64| false;
        // The velocity loop holds its speed within a rpm.
        assert_eq!(verdict(even, Some(0.24), none), Some(Keeps));
        assert_eq!(verdict(|_| 29.0, Some(0.24), none), Some(Keeps));
        // The free wheel of the arithmetic, and one that runs for seconds.
        assert_eq!(verdict(by(1_000.0), Some(0.0), none), Some(Coasts));
        assert_eq!(verdict(by(12.0), Some(0.0), none), Some(Coasts));
        assert_eq!(verdict(by(12.0), None, none), Some(Coasts));
        // A brake of the published time, and a full short.
        let published = |t_s: f64| 30.0 * (-t_s / 0.052).exp();
        assert_eq!(verdict(published, Some(0.06), none), Some(Brakes));
        assert_eq!(verdict(published, None, none), Some(Brakes));
        assert_eq!(verdict(by(6_000.0), Some(0.0), none), Some(Brakes));
    }

    #[test]
    fn missing_replies_are_not_measurable() {
        let by = |rpm_s: f64| move |t_s: f64| 30.0 - rpm_s * t_s;
        let even = |_: f64| 30.0;
        assert_eq!(verdict(even, Some(0.2), |_| true), None);
        // Nothing of the end, and nothing of the fall.
        assert_eq!(verdict(even, Some(0.2), |t_s| t_s > 0.4), None);
        let fall = |t_s: f64| (0.095..0.2).contains(&t_s);
        assert_eq!(verdict(by(1_000.0), Some(0.0), fall), None);
    }

    #[test]
    fn each_behaviour_has_a_name_in_a_file() {
        let all = [WhenSilent::Keeps, WhenSilent::Coasts, WhenSilent::Brakes];
        assert_eq!(all.map(WhenSilent::key), ["keeps", "coasts", "brakes"]);
        for it in all {
            assert_eq!(WhenSilent::from_key(it.key()), Some(it));
        }
        assert_eq!(WhenSilent::from_key(""), None);
    }
}
