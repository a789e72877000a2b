//! Limits of every frame on the wire, by what really reached the motors and what really came back.

use std::{
    collections::{BTreeMap, BTreeSet, VecDeque},
    time::Duration,
};

use motorlink_bus::{Consent, HIGH_CURRENT_RAW, Limits};
use motorlink_protocol::{
    Drive, FRAME_LEN, Frame, Instant, Mode, MotorId,
    family::{Model, Request},
};
use motorlink_simulator::{VirtualMotor, World};

use super::said::loop_of;
use crate::rule::{Rule, Violation, broken};

/// Older telemetry is unknown.
const FRESH_FOR: Duration = Duration::from_millis(500);
/// The address of all motors.
const ALL: u8 = 0xC8;
/// Most replies that may still arrive: motors send no more during the longest hold of an adapter.
const REPLIES_KEPT: usize = 64;
/// Bytes that reached the host, kept to find replies in pieces.
const BYTES_KEPT: usize = 4 * FRAME_LEN;

/// What the host can know about each motor, and what each motor was sent.
#[derive(Debug, Default)]
pub(super) struct Bounds {
    model: Model,
    motors: BTreeMap<MotorId, Known>,
    replies: VecDeque<Reply>,
    arrived: VecDeque<u8>,
    /// Motors with consent to a high current.
    consented: BTreeSet<MotorId>,
    /// Of frames from before this moment the page knows nothing.
    known_since: Instant,
}

/// A reply that a motor sent.
#[derive(Clone, Copy, Debug)]
struct Reply {
    at: Instant,
    frame: Frame,
    answers_zero: bool,
}

#[derive(Clone, Debug, Default)]
struct Known {
    /// The loop in its last reply, and when that reply reached the host.
    reported: Option<(Instant, Mode)>,
    /// Mode switches on the wire since that reply was sent.
    switches: Vec<(Instant, Mode)>,
    torque: Torque,
}

/// Torque that a motor was sent.
#[derive(Clone, Copy, Debug, Default)]
enum Torque {
    #[default]
    None,
    /// Torque of this sign. A zero after it is not answered yet.
    Commanded { sign: i16, is_zero: bool },
    /// The zero was answered.
    ZeroAnswered,
}

impl Bounds {
    pub(super) fn of(model: Model) -> Self {
        Self {
            model,
            ..Self::default()
        }
    }

    /// The port is closed: a new bus knows nothing. The motors stay as they are.
    pub(super) fn port_lost(&mut self) {
        for known in self.motors.values_mut() {
            (known.reported, known.switches) = (None, Vec::new());
        }
        self.replies.clear();
        self.arrived.clear();
        self.consented.clear();
    }

    /// The page knows of nothing that was driven.
    pub(super) fn knows_nothing(&mut self, now: Instant) {
        self.known_since = now;
    }

    /// An operator's setpoint was accepted.
    pub(super) fn on_command(&mut self, id: MotorId, consent: Consent) {
        if consent == Consent::HighCurrent {
            self.consented.insert(id);
        } else {
            self.consented.remove(&id);
        }
    }

    /// The motors have advanced to now.
    pub(super) fn moved(&mut self, world: &World) {
        for motor in world.motors() {
            let torque = &mut self.motors.entry(motor.id()).or_default().torque;
            // Without a controller a torque reverses as in the current loop.
            let has_torque = matches!(motor.mode(), Mode::Current | Mode::OpenLoop);
            let is_known = |received: Instant| has_torque && received >= self.known_since;
            let obeyed = motor.obeyed().filter(|(received, _)| is_known(*received));
            *torque = match (*torque, obeyed.map(|(_, drive)| drive.signed())) {
                // A coasting wheel has no torque to reverse.
                (_, None) => Torque::None,
                (Torque::Commanded { sign, .. }, Some(0)) => Torque::Commanded {
                    sign,
                    is_zero: true,
                },
                (other, Some(0)) => other,
                (_, Some(value)) => Torque::Commanded {
                    sign: value.signum(),
                    is_zero: false,
                },
            };
        }
    }

    /// A motor replies.
    pub(super) fn replied(&mut self, at: Instant, frame: Frame, world: &World) {
        let [id, ..] = *frame.bytes();
        let motor = MotorId::new(id).ok().and_then(|id| world.motor(id));
        let received = motor.and_then(VirtualMotor::last_drive);
        if self.replies.len() >= REPLIES_KEPT {
            self.replies.pop_front();
        }
        self.replies.push_back(Reply {
            at,
            frame,
            answers_zero: received.is_some_and(|(_, drive)| drive.signed() == 0),
        });
    }

    /// Bytes reach the host.
    pub(super) fn delivered(&mut self, now: Instant, bytes: &[u8]) {
        self.arrived.extend(bytes);
        let arrived: &[u8] = self.arrived.make_contiguous();
        let (model, motors) = (self.model, &mut self.motors);
        self.replies.retain(|reply| {
            let frame = reply.frame.bytes();
            let is_there = arrived.windows(FRAME_LEN).any(|window| window == frame);
            if let (true, Some((id, mode))) = (is_there, loop_of(model, &reply.frame)) {
                motors
                    .entry(id)
                    .or_default()
                    .received(now, reply, mode, model);
            }
            !is_there
        });
        let old = self.arrived.len().saturating_sub(BYTES_KEPT);
        self.arrived.drain(..old);
    }

    /// The loop that a mode switch asks for, to one motor or all.
    fn switched_by(&self, frame: &Frame) -> Option<Mode> {
        let [_, command, mode, .., last] = *frame.bytes();
        let byte = if self.model.has_separate_frames() {
            mode
        } else {
            last
        };
        self.model.mode_of(byte).filter(|_| command == 0xA0)
    }

    /// A whole frame goes out; `raw` is the consent to a raw frame. Returns the rules that were
    /// applied.
    pub(super) fn sent(
        &mut self,
        now: Instant,
        frame: Frame,
        raw: Option<Consent>,
        limits: Limits,
        world: &World,
    ) -> Result<Vec<Rule>, Violation> {
        let mut judged = Vec::new();
        let [first, command, high, low, .., brake, _, _] = *frame.bytes();
        let ids: Vec<MotorId> = world
            .motors()
            .map(VirtualMotor::id)
            .filter(|id| first == ALL || first == id.get())
            .collect();
        if let Some(mode) = self.switched_by(&frame) {
            for id in ids {
                self.motors
                    .entry(id)
                    .or_default()
                    .switches
                    .push((now, mode));
            }
            return Ok(judged);
        }
        if command != 0x64 || Request::parse(self.model, &frame) == Ok(Request::IdQuery) {
            return Ok(judged);
        }
        let value = i16::from_be_bytes([high, low]);
        let units = u16::from(self.model.spec().speed_units_per_rpm);
        let full_scale_ma = |model: Model| u32::from(model.spec().current.milliamps());
        let scale = (full_scale_ma(self.model), full_scale_ma(Model::Ddsm115));
        for id in ids {
            let known = self.motors.entry(id).or_default();
            let limit_raw = limits.speed_rpm() * units;
            let above_speed = value.unsigned_abs() > limit_raw && brake != Drive::BRAKE;
            let high_current =
                u32::from(value.unsigned_abs()) * scale.0 > u32::from(HIGH_CURRENT_RAW) * scale.1;
            if above_speed || high_current {
                judged.push(Rule::NothingAboveALimit);
            }
            let is_raw = raw.is_some();
            let consents = raw.map_or(self.consented.contains(&id), |raw| {
                raw == Consent::HighCurrent
            });
            let what = if above_speed && known.may_be_in(Mode::Velocity, now, is_raw) {
                Some("speed")
            } else if high_current && !consents && known.may_be_in(Mode::Current, now, is_raw) {
                Some("current")
            } else {
                None
            };
            if let Some(what) = what {
                let by = if is_raw { "a person" } else { "the bus" };
                let limit = limits.speed_rpm();
                let what = format!(
                    "{frame} of {by} to {id}, a {what} with a limit of {limit} rpm; {:?} told, {:?} on the way",
                    known.reported, known.switches
                );
                return broken(Rule::NothingAboveALimit, now, what);
            }
            let reverses = match known.torque {
                Torque::Commanded { sign, .. } => sign * value.signum() < 0,
                _ => false,
            };
            let passes = matches!(known.torque, Torque::ZeroAnswered);
            if !is_raw && value != 0 && (reverses || passes) {
                judged.push(Rule::ReversalPassesZero);
            }
            if !is_raw && reverses {
                let what = format!("{frame}: {id} was told {:?}", known.torque);
                return broken(Rule::ReversalPassesZero, now, what);
            }
        }
        Ok(judged)
    }
}

impl Known {
    /// A reply reaches the host. One of a model with separate frames may say nothing of the loop.
    fn received(&mut self, now: Instant, reply: &Reply, mode: Option<Mode>, model: Model) {
        if let Some(mode) = mode {
            self.reported = Some((now, mode));
            self.switches
                .retain(|(sent, _)| *sent + model.frame_airtime() >= reply.at);
        }
        if let Torque::Commanded { is_zero: true, .. } = self.torque
            && reply.answers_zero
        {
            self.torque = Torque::ZeroAnswered;
        }
    }

    /// Whether the motor may be in a loop, by all that the host can know. Another rule makes the
    /// bus withdraw the setpoint of a silent motor.
    fn may_be_in(&self, mode: Mode, now: Instant, is_raw: bool) -> bool {
        let on_the_way = self.switches.iter().any(|(_, to)| *to == mode);
        on_the_way
            || self.reported.is_none_or(|(at, reported)| {
                let is_old = is_raw && now.since(at) > FRESH_FOR;
                reported == mode || is_old
            })
    }
}
