//! The newest telemetry of each motor of a run, and what ends the run by it.

use std::time::Duration;

use motorlink_protocol::{
    Current, Detail, Faults, Instant, Mode, MotorId, PositionTarget, Reply, Setpoint, SpeedTarget,
};

use super::{Cause, Crossed, FRESH_FOR, StartRefusal};
use crate::{
    plan::PlanMotor,
    sequence::{Condition, Quantity, RunLimits},
};

/// A current above its limit is tolerated for this long, as by the bus: a starting wheel draws more for a
/// moment.
const OVERCURRENT_FOR: Duration = Duration::from_millis(500);

/// What a motor reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telemetry {
    /// Which motor.
    pub id: MotorId,
    /// When its last byte was received.
    pub at: Instant,
    /// Its loop.
    pub mode: Mode,
    /// Speed in rpm.
    pub rpm: i16,
    /// Torque current.
    pub current: Current,
    /// Angle in degrees, in the layout of a drive frame.
    pub degrees: Option<f32>,
    /// Temperature in deg C, in the layout of a feedback query.
    pub celsius: Option<u8>,
    /// Its faults.
    pub faults: Faults,
}

impl Telemetry {
    /// What this reply says.
    #[must_use]
    pub fn of(at: Instant, reply: &Reply) -> Self {
        let (degrees, celsius) = match reply.detail {
            Detail::Drive { position } => (Some(position.degrees()), None),
            Detail::Query { temperature, .. } => (None, Some(temperature.degrees())),
            Detail::Undetermined(_) => (None, None),
        };
        Self {
            id: reply.id,
            at,
            mode: reply.mode,
            rpm: reply.speed.rpm(),
            current: reply.current,
            degrees,
            celsius,
            faults: reply.faults,
        }
    }
}

/// A value with its time.
type Timed<T> = Option<(Instant, T)>;

#[derive(Clone, Debug)]
struct Known {
    id: MotorId,
    newest: Option<Telemetry>,
    degrees: Timed<f64>,
    celsius: Timed<f64>,
    over_current_since: Option<Instant>,
}

/// What the motors of a run have reported, in the order of the plan.
#[derive(Clone, Debug)]
pub(super) struct Watch(Vec<Known>);

impl Watch {
    pub(super) fn of(ids: impl Iterator<Item = MotorId>) -> Self {
        let unknown = |id| Known {
            id,
            newest: None,
            degrees: None,
            celsius: None,
            over_current_since: None,
        };
        Self(ids.map(unknown).collect())
    }

    /// Takes a reply; gives what it ends a run for.
    pub(super) fn hear(
        &mut self,
        place: usize,
        told: Telemetry,
        motor: &PlanMotor,
        limits: RunLimits,
    ) -> Option<Cause> {
        let known = self.0.get_mut(place)?;
        known.newest = Some(told);
        if let Some(degrees) = told.degrees {
            known.degrees = Some((told.at, degrees.into()));
        }
        if let Some(celsius) = told.celsius {
            known.celsius = Some((told.at, celsius.into()));
        }
        if told.faults.any_named() {
            return Some(Cause::Fault(told.id, told.faults));
        }
        if told.mode != motor.mode() {
            return Some(Cause::OtherLoop(told.id, told.mode));
        }
        known
            .crossed(told, limits)
            .map(|crossed| Cause::Limit(told.id, crossed))
    }

    /// The first motor without a reply of the last half second.
    pub(super) fn silent(&self, now: Instant) -> Option<MotorId> {
        let fresh = |known: &Known| {
            known
                .newest
                .is_some_and(|told| now.since(told.at) <= FRESH_FOR)
        };
        let silent = self.0.iter().find(|known| !fresh(known));
        silent.map(|known| known.id)
    }

    /// The setpoint with which a motor begins: no speed, no current, or the angle that it has.
    pub(super) fn ready(&self, motor: &PlanMotor, now: Instant) -> Result<Setpoint, StartRefusal> {
        let id = motor.id;
        let known = self.0.iter().find(|known| known.id == id);
        let known = known.ok_or(StartRefusal::NotAnswering(id))?;
        let fresh = |told: &Telemetry| now.since(told.at) <= FRESH_FOR;
        let told = known.newest.filter(fresh);
        let told = told.ok_or(StartRefusal::NotAnswering(id))?;
        if told.faults.any_named() {
            return Err(StartRefusal::Fault(id, told.faults));
        }
        if told.mode != motor.mode() {
            return Err(StartRefusal::OtherLoop {
                id,
                needed: motor.mode(),
                reported: told.mode,
            });
        }
        if motor.quantity != Quantity::Degrees {
            return Ok(neutral(motor.quantity));
        }
        let fresh = |(at, _): &(Instant, f64)| now.since(*at) <= FRESH_FOR;
        let (_, degrees) = known
            .degrees
            .filter(fresh)
            .ok_or(StartRefusal::NoAngle(id))?;
        Ok(setpoint_of(Quantity::Degrees, degrees))
    }

    /// Whether a condition holds for a motor, by telemetry that is not older than `since`.
    pub(super) fn holds(&self, place: usize, condition: Condition, since: Instant) -> bool {
        let Some(known) = self.0.get(place) else {
            return false;
        };
        let newest = known.newest.filter(|told| told.at >= since);
        let rpm = newest.map(|told| f64::from(told.rpm).abs());
        let recent = |value: Timed<f64>| value.filter(|(at, _)| *at >= since);
        // Temperature changes in minutes and is asked for seldom: an older value counts.
        let celsius = known.celsius.map(|(_, celsius)| celsius);
        match condition {
            Condition::RpmAbove(least) => rpm.is_some_and(|rpm| rpm >= least),
            Condition::RpmBelow(most) => rpm.is_some_and(|rpm| rpm <= most),
            Condition::CelsiusAbove(least) => celsius.is_some_and(|celsius| celsius >= least),
            Condition::CelsiusBelow(most) => celsius.is_some_and(|celsius| celsius <= most),
            Condition::DegreesNear { degrees, tolerance } => {
                recent(known.degrees).is_some_and(|(_, at)| {
                    let off = (at - degrees + 180.0).rem_euclid(360.0) - 180.0;
                    off.abs() <= tolerance
                })
            }
        }
    }
}

impl Known {
    fn crossed(&mut self, told: Telemetry, limits: RunLimits) -> Option<Crossed> {
        let above = |value: f64, limit: Option<f64>| limit.filter(|limit| value > *limit);
        let rpm = f64::from(told.rpm).abs();
        let amps = f64::from(told.current.amps()).abs();
        if let Some(limit) = above(rpm, limits.rpm) {
            return Some(Crossed::Rpm {
                reached: rpm,
                limit,
            });
        }
        if let Some(limit) = above(amps, limits.amps) {
            let since = *self.over_current_since.get_or_insert(told.at);
            if told.at.since(since) >= OVERCURRENT_FOR {
                return Some(Crossed::Amps {
                    reached: amps,
                    limit,
                });
            }
        } else {
            self.over_current_since = None;
        }
        let celsius = told.celsius.map(f64::from)?;
        above(celsius, limits.celsius).map(|limit| Crossed::Celsius {
            reached: celsius,
            limit,
        })
    }
}

/// No speed or no current; an angle has no neutral value.
pub(super) fn neutral(quantity: Quantity) -> Setpoint {
    setpoint_of(quantity, 0.0)
}

/// The setpoint of this value at the motor's own acceleration, in the steps of the wire.
#[allow(
    clippy::cast_possible_truncation,
    reason = "the plan has checked the range; what the wire carries is coarser than f32"
)]
pub(super) fn setpoint_of(quantity: Quantity, value: f64) -> Setpoint {
    match quantity {
        Quantity::Rpm => Setpoint::velocity(SpeedTarget::clamped(value.round() as i32)),
        Quantity::Amps => {
            Setpoint::Current(motorlink_protocol::CurrentTarget::from_amps(value as f32))
        }
        Quantity::Degrees => Setpoint::Position(PositionTarget::from_degrees(value as f32)),
    }
}
