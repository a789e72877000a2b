//! Whether reported telemetry is true.

use std::{
    collections::{BTreeMap, VecDeque},
    time::Duration,
};

use motorlink_bus::{Event, Sample, StopOutcome};
use motorlink_protocol::{Detail, Frame, Instant, MotorId, family::Model};
use motorlink_simulator::{VirtualMotor, World};

use super::said::tells;
use crate::rule::{Outcome, Rule, broken};

/// A sensor's step, noise, and the time that a reply was held.
const TEMPERATURE_OFF_MAX_C: f32 = 4.0;
/// For a standing wheel, including coarse steps of 1.4 degrees.
const ANGLE_OFF_MAX_DEG: f32 = 6.0;
/// Largest age of a reply.
const REPLY_HELD_MAX: Duration = Duration::from_millis(250);
/// Below this speed a wheel stands.
const STANDS_RPM: f32 = 1.0;
/// Highest speed of a wheel with confirmed standstill: it may be pushed.
const CONFIRMED_RPM: f32 = 10.0;

/// Recent replies kept: more than any adapter holds.
const SAID_MAX: usize = 256;

/// True state of the motors.
#[derive(Debug, Default)]
pub(super) struct Truth {
    model: Model,
    /// When a motor's temperature was last set.
    heated: Option<Instant>,
    /// Since when a wheel stands, and at which angle.
    standing: BTreeMap<MotorId, (Instant, f32)>,
    /// Their replies, newest last.
    said: VecDeque<Frame>,
}

impl Truth {
    pub(super) fn of(model: Model) -> Self {
        Self {
            model,
            ..Self::default()
        }
    }

    /// The temperature of a motor was set.
    pub(super) fn heated(&mut self, now: Instant) {
        self.heated = Some(now);
    }

    /// Replies arrive later than usual.
    pub(super) fn on_absence(&mut self) {
        self.standing.clear();
    }

    /// A motor replies.
    pub(super) fn replied(&mut self, frame: Frame) {
        if self.said.len() >= SAID_MAX {
            self.said.pop_front();
        }
        self.said.push_back(frame);
    }

    /// Time has passed.
    pub(super) fn passed(&mut self, now: Instant, world: &World) {
        for motor in world.motors() {
            let angle = motor.angle_deg();
            let stays = self.standing.get(&motor.id()).is_some_and(|(_, before)| {
                apart(angle, *before) < STANDS_RPM && motor.speed_rpm().abs() < STANDS_RPM
            });
            if !stays {
                self.standing.insert(motor.id(), (now, angle));
            }
        }
    }

    /// The bus reports an event.
    pub(super) fn on_event(&self, now: Instant, event: &Event, world: &World) -> Outcome {
        match event {
            Event::Telemetry(sample) => self.reported(now, sample, world),
            _ => Ok(()),
        }
    }

    fn reported(&self, now: Instant, sample: &Sample, world: &World) -> Outcome {
        let reply = sample.reply;
        let Some(motor) = world.motor(reply.id) else {
            return Ok(());
        };
        let is_said = |said: &Frame| tells(self.model, said, &reply);
        if !self.said.iter().rev().any(is_said) {
            let what = format!("{reply:?}, which no motor has said");
            return broken(Rule::TelemetryIsTrue, now, what);
        }
        if let Detail::Query { temperature, .. } | Detail::Temperature(temperature) = reply.detail
            && self.heated.is_none_or(|at| now.since(at) >= REPLY_HELD_MAX)
        {
            let (read, truth) = (f32::from(temperature.degrees()), motor.temperature_c());
            if (read - truth).abs() > TEMPERATURE_OFF_MAX_C {
                let what = format!("{} reads {read} for {truth} degrees", reply.id);
                return broken(Rule::TelemetryIsTrue, now, what);
            }
        }
        let stands = self.standing.get(&reply.id);
        let Some((_, truth)) = stands.filter(|(since, _)| now.since(*since) > REPLY_HELD_MAX)
        else {
            return Ok(());
        };
        let read = match reply.detail {
            Detail::Drive { position } | Detail::Odometry { position, .. } => position.degrees(),
            Detail::Query { position, .. } => position.degrees(),
            Detail::Temperature(_) | Detail::Undetermined(_) => return Ok(()),
        };
        if apart(read, *truth) > ANGLE_OFF_MAX_DEG {
            let what = format!("{} reads {read} for {truth} degrees of angle", reply.id);
            return broken(Rule::TelemetryIsTrue, now, what);
        }
        Ok(())
    }
}

/// A motor that is reported to stand does.
pub(super) fn confirmed(rule: Rule, now: Instant, outcome: StopOutcome, world: &World) -> Outcome {
    let speed = world.motor(outcome.id).map_or(0.0, VirtualMotor::speed_rpm);
    if outcome.confirmed && speed.abs() > CONFIRMED_RPM {
        let what = format!("{} is said to stand, and turns at {speed} rpm", outcome.id);
        return broken(rule, now, what);
    }
    Ok(())
}

/// Distance of two angles in degrees.
fn apart(one: f32, other: f32) -> f32 {
    let apart = (one - other).rem_euclid(360.0);
    apart.min(360.0 - apart)
}
