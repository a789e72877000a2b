//! Estimate of the wheel's angle, from the last certain angle and the speed since (dead reckoning).
//!
//! Every reply reports the speed, but after lost replies the meaning of bytes 6 and 7 may stay
//! uncertain for long. Hold cannot wait for that.

use std::time::Duration;

use motorlink_protocol::{
    Celsius, CoarsePosition, Detail, Instant, Position, PositionTarget, Reply, Rpm,
};

use crate::angle_fit::AngleFit;
use crate::timing::{DRIVEN_SILENCE_MAX, FRESH_FOR, HOLD_REFINED_WITHIN};

/// An uncertain reading this near to the estimate confirms it: four steps of the coarse angle.
const NEAR_DEG: f32 = 5.6;
/// Replies closer together than this do not show how the speed changes: they report it in whole
/// rpm.
const TELLS_GAIN: Duration = Duration::from_millis(5);
/// The fastest wheel, 330 rpm.
const FASTEST_DPS: f32 = 1_980.0;
/// Largest change of the temperature between two readings: 10 readings per second of a winding that
/// takes minutes to heat.
const TEMPERATURE_STEP_MAX: u8 = 3;

/// The estimated angle of one wheel.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AngleEstimate {
    last: Option<Estimate>,
    temperature: Option<Celsius>,
    fit: AngleFit,
}

#[derive(Clone, Copy, Debug)]
struct Estimate {
    at: Instant,
    degrees: f32,
    speed: Rpm,
    /// Change of the speed since the reply before, in degrees per second squared.
    gain_dps2: f32,
    /// When a reply last reported or confirmed the angle.
    seen: Instant,
}

impl Estimate {
    /// The angle at a later time, at constant speed.
    fn advanced_to(self, at: Instant, speed_dps: f32) -> f32 {
        (self.degrees + speed_dps * at.since(self.at).as_secs_f32()).rem_euclid(360.0)
    }

    /// Change of the speed up to the next reply, if they are far enough apart to show one.
    fn gain_to(self, at: Instant, speed: Rpm) -> f32 {
        let apart = at.since(self.at);
        if apart < TELLS_GAIN {
            return self.gain_dps2;
        }
        (speed.degrees_per_second() - self.speed.degrees_per_second()) / apart.as_secs_f32()
    }

    /// The angle at a later time if the speed keeps changing at this rate, at most to a standstill.
    fn extrapolated_to(self, at: Instant) -> f32 {
        let from_dps = self.speed.degrees_per_second();
        let to_dps = from_dps + self.gain_dps2 * at.since(self.at).as_secs_f32();
        let to_dps = if from_dps < 0.0 {
            limited(to_dps, -FASTEST_DPS, 0.0)
        } else {
            limited(to_dps, 0.0, FASTEST_DPS)
        };
        self.advanced_to(at, f32::midpoint(from_dps, to_dps))
    }
}

impl AngleEstimate {
    /// Updates the estimate with a reply that arrived in its window.
    pub(crate) fn replied(&mut self, at: Instant, reply: &Reply) {
        let Some(speed) = reply.speed else {
            return;
        };
        self.fit.replied(at, speed, reply.detail);
        let carried = self.last.map(|before| {
            let mean_dps = f32::midpoint(
                before.speed.degrees_per_second(),
                speed.degrees_per_second(),
            );
            (before.advanced_to(at, mean_dps), before.seen)
        });
        let angle = match reply.detail {
            Detail::Drive { position } | Detail::Odometry { position, .. } => {
                Some((position.degrees(), at))
            }
            Detail::Query {
                position,
                temperature,
            } => {
                self.temperature = Some(temperature);
                // The coarse angle is one degree off. An estimate over a short time is better.
                let coarse = position.degrees();
                let fine = carried.filter(|(degrees, _)| apart(*degrees, coarse) <= NEAR_DEG / 2.0);
                Some((fine.map_or(coarse, |(degrees, _)| degrees), at))
            }
            Detail::Temperature(temperature) => {
                self.temperature = Some(temperature);
                carried
            }
            Detail::Undetermined(bytes) => carried.map(|(degrees, seen)| {
                self.read_uncertain(bytes, degrees)
                    .map_or((degrees, seen), |read| (read, at))
            }),
        };
        let gain_dps2 = self.last.map_or(0.0, |before| before.gain_to(at, speed));
        self.last = angle.map(|(degrees, seen)| Estimate {
            at,
            degrees,
            speed,
            gain_dps2,
            seen,
        });
    }

    /// The angle in bytes 6 and 7, if only one of their two meanings is possible: byte 6 is no
    /// plausible temperature, or one meaning is near the estimate.
    fn read_uncertain(&self, bytes: [u8; 2], estimated: f32) -> Option<f32> {
        let [high, low] = bytes;
        let fine = Position::from_raw(u16::from_be_bytes(bytes)).degrees();
        let coarse = CoarsePosition::from_raw(low).degrees();
        let may_be_temperature = self
            .temperature
            .is_none_or(|temperature| temperature.degrees().abs_diff(high) <= TEMPERATURE_STEP_MAX);
        if !may_be_temperature {
            return Some(fine);
        }
        let readings = [fine, coarse].into_iter();
        let nearest = readings.min_by(|a, b| apart(*a, estimated).total_cmp(&apart(*b, estimated)));
        nearest.filter(|read| apart(*read, estimated) <= NEAR_DEG)
    }

    /// The angle that a reply at `now` has reported or confirmed.
    pub(crate) fn confirmed_now(&self, now: Instant) -> Option<f32> {
        let last = self.last.filter(|last| last.seen == now)?;
        Some(last.degrees)
    }

    /// A hold from now on and its first angle; `None` if the angle is unknown or does not fit the motion.
    pub(crate) fn hold(&self, now: Instant) -> Option<(Hold, PositionTarget)> {
        if self.misfits() {
            return None;
        }
        let speed = self.last?.speed;
        let degrees = self.degrees(now)?;
        let hold = Hold { at: now, speed };
        Some((hold, PositionTarget::from_degrees(degrees)))
    }

    /// Whether the angle has been found not to fit the motion.
    pub(crate) const fn misfits(&self) -> bool {
        self.fit.misfits()
    }

    /// The angle now; `None` without a reply for 200 ms, or without a reported or confirmed angle
    /// for 500 ms.
    pub(crate) fn degrees(&self, now: Instant) -> Option<f32> {
        let last = self.last?;
        let known = now.since(last.at) < DRIVEN_SILENCE_MAX && now.since(last.seen) <= FRESH_FOR;
        known.then(|| last.extrapolated_to(now))
    }
}

/// The start of a hold, until a reply tells precisely where the wheel was then.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hold {
    at: Instant,
    /// By the last reply before it.
    speed: Rpm,
}

impl Hold {
    pub(crate) const fn began(self) -> Instant {
        self.at
    }

    /// Whether a reply can still refine the angle. Until then frames go out as often as those of a
    /// stop.
    pub(crate) fn is_open(self, now: Instant) -> bool {
        now.since(self.at) < HOLD_REFINED_WITHIN
    }

    /// The refined angle, from the first reply after Hold; `None` if the reply is too late.
    pub(crate) fn refined(
        self,
        now: Instant,
        degrees: Option<f32>,
        speed: Rpm,
    ) -> Option<PositionTarget> {
        let elapsed = now.since(self.at);
        let degrees = degrees.filter(|_| self.is_open(now))?;
        let mean_dps = f32::midpoint(self.speed.degrees_per_second(), speed.degrees_per_second());
        let then = degrees - mean_dps * elapsed.as_secs_f32();
        Some(PositionTarget::from_degrees(then.rem_euclid(360.0)))
    }
}

/// Distance of two angles, 0-180 degrees.
fn apart(one: f32, other: f32) -> f32 {
    ((one - other + 180.0).rem_euclid(360.0) - 180.0).abs()
}

/// The value, or the bound that it exceeds.
#[allow(
    clippy::manual_clamp,
    reason = "the panic of `f32::clamp` writes its bounds, and that code adds kilobytes to the web page"
)]
const fn limited(value: f32, low: f32, high: f32) -> f32 {
    value.max(low).min(high)
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{Current, Faults, Mode, MotorId};

    use super::*;

    /// +60 rpm lets the angle fall by 360 degrees a second.
    fn reply(degrees: Option<f32>, rpm: i16) -> Reply {
        let raw = |degrees: f32| (degrees * 32_767.0 / 360.0).round();
        Reply {
            id: MotorId::FIRST,
            mode: Mode::Position,
            current: Some(Current::from_raw(0)),
            speed: Some(Rpm::new(rpm)),
            detail: match degrees {
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "0-360 degrees"
                )]
                Some(degrees) => Detail::Drive {
                    position: Position::from_raw(raw(degrees) as u16),
                },
                None => Detail::Undetermined([0x1C, 0x55]),
            },
            faults: Faults::NONE,
        }
    }

    fn at(ms: u64) -> Instant {
        Instant::from_millis(ms)
    }

    fn near(angle_estimate: &AngleEstimate, ms: u64, degrees: f32) {
        let found = angle_estimate.degrees(at(ms)).expect("a known angle");
        assert!(apart(found, degrees) < 0.1, "{found}, not {degrees}");
    }

    #[test]
    fn an_angle_goes_on_with_the_speed() {
        let mut angle_estimate = AngleEstimate::default();
        assert_eq!(angle_estimate.degrees(at(0)), None);
        angle_estimate.replied(at(0), &reply(Some(10.0), 60));
        near(&angle_estimate, 50, 352.0);
        // Uncertain, and far from where the wheel can be.
        angle_estimate.replied(at(100), &reply(None, 60));
        near(&angle_estimate, 100, 334.0);
        near(&angle_estimate, 150, 316.0);
    }

    #[test]
    fn an_uncertain_angle_near_the_reckoned_one_confirms_it() {
        let mut angle_estimate = AngleEstimate::default();
        angle_estimate.replied(at(0), &reply(Some(40.0), 0));
        // 0x1C55 is 79.7 degrees as a fine angle.
        angle_estimate.replied(at(100), &reply(None, -100));
        near(&angle_estimate, 100, 70.0);
        angle_estimate.replied(at(110), &reply(None, -100));
        near(&angle_estimate, 110, 79.686);
    }

    #[test]
    fn a_first_byte_that_is_no_temperature_begins_an_angle() {
        let mut angle_estimate = AngleEstimate::default();
        let mut query = reply(None, 0);
        query.detail = Detail::Query {
            temperature: Celsius::new(30),
            position: CoarsePosition::from_raw(0),
        };
        angle_estimate.replied(at(0), &query);
        // 0x1C is 28 degrees Celsius, and may be a temperature.
        angle_estimate.replied(at(20), &reply(None, 0));
        near(&angle_estimate, 20, 0.0);
        query.detail = Detail::Query {
            temperature: Celsius::new(40),
            position: CoarsePosition::from_raw(0),
        };
        angle_estimate.replied(at(40), &query);
        angle_estimate.replied(at(60), &reply(None, 0));
        near(&angle_estimate, 60, 79.686);
    }

    #[test]
    fn an_angle_that_nothing_confirms_is_unknown_after_half_a_second() {
        let mut angle_estimate = AngleEstimate::default();
        angle_estimate.replied(at(0), &reply(Some(10.0), 0));
        for ms in (100..=500).step_by(100) {
            angle_estimate.replied(at(ms), &reply(None, 0));
        }
        assert!(angle_estimate.degrees(at(500)).is_some());
        assert_eq!(angle_estimate.degrees(at(501)), None);
    }

    #[test]
    fn a_motor_that_does_not_answer_has_no_angle_after_200_ms() {
        let mut angle_estimate = AngleEstimate::default();
        angle_estimate.replied(at(0), &reply(Some(10.0), 0));
        assert!(angle_estimate.degrees(at(199)).is_some());
        assert_eq!(angle_estimate.degrees(at(200)), None);
    }
}
