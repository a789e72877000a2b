//! The newest telemetry of each motor of a run, and the checks that end the run.

use std::time::Duration;

use motorlink_protocol::{
    Celsius, Current, Faults, Instant, Mode, MotorId, Position, PositionTarget, Reply, Rpm,
    Setpoint, SpeedTarget,
};

use super::{Cause, ExceededLimit, FRESH_FOR, StartRefusal};
use crate::{
    plan::PlanMotor,
    sequence::{Condition, Quantity, RunLimits},
};

/// A current above its limit is tolerated for this long, as on the bus: a starting wheel briefly draws more.
const OVERCURRENT_FOR: Duration = Duration::from_millis(500);

/// What a motor reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telemetry {
    /// The motor.
    pub id: MotorId,
    /// When its last byte was received.
    pub at: Instant,
    /// Its loop.
    pub mode: Mode,
    /// Speed in rpm; `None` if the reply does not tell it.
    pub rpm: Option<i16>,
    /// Torque current; `None` if the reply does not tell it.
    pub current: Option<Current>,
    /// Angle in degrees; replies to drive frames only.
    pub degrees: Option<f32>,
    /// Temperature in deg C; replies to feedback queries only.
    pub celsius: Option<u8>,
    /// Its faults.
    pub faults: Faults,
}

impl Telemetry {
    /// The telemetry in this reply.
    #[must_use]
    pub fn of(at: Instant, reply: &Reply) -> Self {
        let (degrees, celsius) = (
            reply.detail.fine().map(Position::degrees),
            reply.detail.temperature().map(Celsius::degrees),
        );
        Self {
            id: reply.id,
            at,
            mode: reply.mode,
            rpm: reply.speed.map(Rpm::rpm),
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
    rpm: Timed<f64>,
    degrees: Timed<f64>,
    /// The angle from which a position setpoint counts too. An odometry reply, which has no current, counts from elsewhere:
    /// the setpoint from where the position loop was entered.
    setpoint_degrees: Timed<f64>,
    celsius: Timed<f64>,
    over_current_since: Option<Instant>,
}

/// The telemetry of the motors of a run, in the order of the plan.
#[derive(Clone, Debug)]
pub(super) struct Watch(Vec<Known>);

impl Watch {
    pub(super) fn of(ids: impl Iterator<Item = MotorId>) -> Self {
        let unknown = |id| Known {
            id,
            newest: None,
            rpm: None,
            degrees: None,
            setpoint_degrees: None,
            celsius: None,
            over_current_since: None,
        };
        Self(ids.map(unknown).collect())
    }

    /// Takes a reply. Returns a cause if it ends the run.
    pub(super) fn receive(
        &mut self,
        place: usize,
        reply: Telemetry,
        motor: &PlanMotor,
        limits: RunLimits,
    ) -> Option<Cause> {
        let known = self.0.get_mut(place)?;
        known.newest = Some(reply);
        if let Some(rpm) = reply.rpm {
            known.rpm = Some((reply.at, f64::from(rpm).abs()));
        }
        if let Some(degrees) = reply.degrees {
            known.degrees = Some((reply.at, degrees.into()));
            if reply.current.is_some() {
                known.setpoint_degrees = known.degrees;
            }
        }
        if let Some(celsius) = reply.celsius {
            known.celsius = Some((reply.at, celsius.into()));
        }
        if reply.faults.any_named() {
            return Some(Cause::Fault(reply.id, reply.faults));
        }
        if reply.mode != motor.mode() {
            return Some(Cause::OtherLoop(reply.id, reply.mode));
        }
        known
            .exceeded(reply, limits)
            .map(|exceeded| Cause::Limit(reply.id, exceeded))
    }

    /// The first motor that has not replied in the last half second.
    pub(super) fn silent(&self, now: Instant) -> Option<MotorId> {
        let fresh = |known: &Known| {
            known
                .newest
                .is_some_and(|reply| now.since(reply.at) <= FRESH_FOR)
        };
        let silent = self.0.iter().find(|known| !fresh(known));
        silent.map(|known| known.id)
    }

    /// The setpoint with which a motor starts: no speed, no current, or its present angle.
    pub(super) fn ready(&self, motor: &PlanMotor, now: Instant) -> Result<Setpoint, StartRefusal> {
        let id = motor.id;
        let known = self.0.iter().find(|known| known.id == id);
        let known = known.ok_or(StartRefusal::NotAnswering(id))?;
        let fresh = |reply: &Telemetry| now.since(reply.at) <= FRESH_FOR;
        let reply = known.newest.filter(fresh);
        let reply = reply.ok_or(StartRefusal::NotAnswering(id))?;
        if reply.faults.any_named() {
            return Err(StartRefusal::Fault(id, reply.faults));
        }
        if reply.mode != motor.mode() {
            return Err(StartRefusal::OtherLoop {
                id,
                needed: motor.mode(),
                reported: reply.mode,
            });
        }
        if motor.quantity != Quantity::Degrees {
            return Ok(neutral(motor.quantity));
        }
        let fresh = |(at, _): &(Instant, f64)| now.since(*at) <= FRESH_FOR;
        match known.setpoint_degrees.filter(fresh) {
            Some((_, degrees)) => Ok(setpoint_of(Quantity::Degrees, degrees)),
            None if known.degrees.is_some() => Err(StartRefusal::OtherAngle(id)),
            None => Err(StartRefusal::NoAngle(id)),
        }
    }

    /// Whether a condition is fulfilled for a motor, by telemetry that is not older than `since`.
    pub(super) fn holds(&self, place: usize, condition: Condition, since: Instant) -> bool {
        let Some(known) = self.0.get(place) else {
            return false;
        };
        let recent = |value: Timed<f64>| value.filter(|(at, _)| *at >= since);
        let rpm = recent(known.rpm).map(|(_, rpm)| rpm);
        // Temperature changes within minutes and is queried seldom, so an older value is accepted.
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
    fn exceeded(&mut self, reply: Telemetry, limits: RunLimits) -> Option<ExceededLimit> {
        let above = |value: f64, limit: Option<f64>| limit.filter(|limit| value > *limit);
        let rpm = reply.rpm.map(|rpm| f64::from(rpm).abs());
        let amps = reply.current.map(|current| f64::from(current.amps()).abs());
        if let Some(reached) = rpm
            && let Some(limit) = above(reached, limits.rpm)
        {
            return Some(ExceededLimit::Rpm { reached, limit });
        }
        if let Some(reached) = amps
            && let Some(limit) = above(reached, limits.amps)
        {
            let since = *self.over_current_since.get_or_insert(reply.at);
            if reply.at.since(since) >= OVERCURRENT_FOR {
                return Some(ExceededLimit::Amps { reached, limit });
            }
        } else if amps.is_some() {
            self.over_current_since = None;
        }
        let celsius = reply.celsius.map(f64::from)?;
        above(celsius, limits.celsius).map(|limit| ExceededLimit::Celsius {
            reached: celsius,
            limit,
        })
    }
}

/// No speed or no current; an angle has no neutral value.
pub(super) fn neutral(quantity: Quantity) -> Setpoint {
    setpoint_of(quantity, 0.0)
}

/// The setpoint of this value with the motor's own acceleration, in the resolution of the protocol.
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
