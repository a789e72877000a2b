//! Checks the rules after every step.
//!
//! | file | idea |
//! |---|---|
//! | `commands`, `events` | what a command of the operator changes, and what an event of the bus says |
//! | `operator` | which commands are in force, and what may be sent by them |
//! | `wire` | frames on the wire, and their entries in the log |
//! | `said` | what a frame says, and to whom |
//! | `truth` | whether the reported telemetry is true |
//! | `motion` | whether a wheel moves on after a stop or a hold |
//! | `asked` | whether every motor is asked in time |
//! | `in_time` | whether replies come in their windows on a slow line |
//! | `bounds` | limits of every frame on the wire |
//! | `liveness` | what must happen on a good line: brakes, ends of stops, stops after a loss |
//! | `unasked` | whether a motor that moves though nothing drives it is said to |
//! | `invented` | whether every value of a sample was in a reply of that age |

mod asked;
mod bounds;
mod commands;
mod events;
mod in_time;
mod invented;
mod liveness;
mod motion;
mod operator;
mod said;
mod starts;
mod truth;
mod unasked;
mod wire;

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use motorlink_bus::{Bus, Limits};
use motorlink_protocol::family::{Model, Request};
use motorlink_protocol::{Frame, Instant, Mode, MotorId, Setpoint};
use motorlink_simulator::World;

use crate::action::LineFault;
use crate::rule::{Outcome, Rule, broken};

use self::{
    asked::Asked, bounds::Bounds, in_time::InTime, invented::Invented, liveness::Liveness,
    motion::Motion, operator::Operator, said::may_obey, starts::Starts, truth::Truth,
    unasked::Unasked, wire::Wire,
};

/// Longest time until a stop reaches a motor: 10 ms of the bus, and at most 10 ms of the exchange
/// in flight.
const STOP_REACHES_WITHIN: Duration = Duration::from_millis(20);
/// A silent motor delays the next ones by its reply window.
const WINDOW_MAX: Duration = Duration::from_millis(40);
/// A running stop sends a brake and a query to each of at most four motors.
const FRAMES_OF_A_TURN: u32 = 8;
/// A refused frame costs its reply window, and the next frame its airtime.
const REFUSED_COSTS: Duration = Duration::from_millis(45);
/// A stop ends confirmed or after its window of three seconds; scans and switches are over then.
const STOP_ENDS_WITHIN: Duration = Duration::from_secs(4);

/// State of the rules.
#[derive(Debug, Default)]
pub(crate) struct Rules {
    model: Model,
    /// Motors that report no speed, however fast they turn.
    speed_stuck: Vec<MotorId>,
    operator: Operator,
    wire: Wire,
    truth: Truth,
    motion: Motion,
    bounds: Bounds,
    liveness: Liveness,
    invented: Invented,
    asked: Asked,
    in_time: InTime,
    unasked: Unasked,
    starts: Starts,
    /// Motors that must get a stop frame, with the deadline.
    stops: BTreeMap<MotorId, Instant>,
    /// When each motor got its last possible stop frame.
    rested: BTreeMap<MotorId, Instant>,
    /// Motors whose last frame that changes anything was a brake.
    braked: BTreeSet<MotorId>,
    /// Motors that the stop report must name.
    reported: Vec<MotorId>,
    stop_began: Option<Instant>,
    /// How often each rule was applied. A rule that never applies proves nothing.
    pub(crate) judged: BTreeMap<Rule, u64>,
}

impl Rules {
    /// The rules for motors of this model, of which these report no speed.
    pub(crate) fn of(model: Model, speed_stuck: &[MotorId]) -> Self {
        Self {
            model,
            speed_stuck: speed_stuck.to_vec(),
            operator: Operator::of(model),
            wire: Wire::of(model),
            truth: Truth::of(model),
            bounds: Bounds::of(model),
            invented: Invented::of(model),
            ..Self::default()
        }
    }

    pub(crate) fn judge(&mut self, rule: Rule) {
        *self.judged.entry(rule).or_default() += 1;
    }

    /// No call reached the bus for a while; `is_late` is whether for too long.
    pub(crate) fn on_absence(&mut self, now: Instant, is_late: bool, world: &World) {
        self.wire.disturbed(now);
        self.liveness.disturbed();
        self.in_time.disturbed();
        self.invented.on_absence(now);
        self.asked.excused(now);
        self.operator.was_away();
        self.stop_began = self.stop_began.map(|_| now);
        if is_late {
            if self.operator.was_late() {
                self.judge(Rule::GapWithdraws);
            }
            self.stop_begins(now, |_| true);
            self.moves_no_more(now, world, |_| true);
        } else {
            // Earlier replies arrive this late.
            self.truth.on_absence();
        }
        let others = u32::try_from(self.stops.len()).unwrap_or(u32::MAX);
        for until in self.stops.values_mut() {
            *until = now + STOP_REACHES_WITHIN + WINDOW_MAX * others;
        }
    }

    fn stop_begins(&mut self, now: Instant, is_stopped: impl Fn(&MotorId) -> bool) {
        let (driven, others) = self.operator.stop(is_stopped);
        if !driven.is_empty() {
            self.liveness.stop_begins(now, &driven);
        }
        for id in driven {
            self.reported.push(id);
            // The event of a stop that the bus begins comes after its first frame.
            if self.rested.get(&id) == Some(&now) {
                self.judge(Rule::StopIsNext);
                continue;
            }
            // Motors whose stop has just begun come first, each with its reply window.
            let waiting = u32::try_from(self.stops.len()).unwrap_or(u32::MAX);
            // A motor that has stopped before its start goes on, in turn with the others.
            let is_braked = self.starts.waits(id) && self.braked.contains(&id);
            let before = if is_braked {
                FRAMES_OF_A_TURN
            } else {
                others.saturating_add(waiting)
            };
            let until = now + STOP_REACHES_WITHIN + WINDOW_MAX * before;
            self.stops.entry(id).or_insert(until);
        }
    }

    /// All events of this moment are out.
    pub(crate) fn settled(&mut self, now: Instant, bus: &Bus, world: &World) -> Outcome {
        self.wire.settled(now)?;
        for rule in self.liveness.settled(now, bus, world)? {
            self.judge(rule);
        }
        let healthy = self.liveness.healthy_since();
        let judged = self.starts.settled(now, healthy, bus)?;
        *self.judged.entry(Rule::StartEnds).or_default() += judged;
        let judged = self.asked.settled(now, bus)?;
        *self.judged.entry(Rule::AskedInTime).or_default() += judged;
        if self.in_time.settled(now, bus)? {
            self.judge(Rule::RepliesInTime);
        }
        let judged = self.unasked.settled(now, bus)?;
        *self.judged.entry(Rule::UnaskedIsSaid).or_default() += judged;
        self.check_active_setpoints(now, bus)
    }

    fn check_active_setpoints(&mut self, now: Instant, bus: &Bus) -> Outcome {
        self.operator.check_active_setpoints(now, bus)
    }

    /// Whether the page answers.
    pub(crate) fn page(&mut self, now: Instant, answers: bool) {
        self.operator.page(now, answers);
    }

    /// A new bus gets the limits.
    pub(crate) fn limits(&mut self, limits: Limits) {
        self.operator.limits = limits;
    }

    /// The temperature of a motor was set.
    pub(crate) fn heated(&mut self, now: Instant) {
        self.truth.heated(now);
    }

    /// The line was set healthy or faulty; `None` if it carries nothing.
    pub(crate) fn line(&mut self, now: Instant, line: Option<LineFault>) {
        let is_good = line == Some(LineFault::None);
        self.wire.line(now, is_good);
        self.liveness.line(is_good);
        self.in_time.line(line);
    }

    /// The port is closed: no setpoint is in force.
    pub(crate) fn port_lost(&mut self, now: Instant, world: &World) {
        self.moves_no_more(now, world, |_| true);
        self.bounds.port_lost();
        self.liveness.port_lost();
        self.asked = Asked::default();
        self.braked.clear();
        self.in_time.disturbed();
        self.unasked = Unasked::default();
        self.starts = Starts::default();
        self.operator.port_lost();
        self.wire.port_lost();
        self.stops.clear();
        self.reported.clear();
        self.stop_began = None;
    }

    /// A port is open again.
    pub(crate) fn port_opened(&mut self, now: Instant, world: &World) {
        self.liveness.port_opened(now, world);
        // What an adapter held meanwhile arrives now.
        self.invented.on_absence(now);
        self.asked.excused(now);
    }

    /// The page knows of nothing that was driven.
    pub(crate) fn knows_nothing(&mut self, now: Instant) {
        self.liveness.knows_nothing();
        self.bounds.knows_nothing(now);
    }

    /// A line that was dead passes frames again.
    pub(crate) fn line_back(&mut self, now: Instant, bus: &Bus, world: &World) {
        self.liveness.line_back(now, bus, world);
    }

    /// A frame goes out.
    pub(crate) fn sent(&mut self, now: Instant, frame: Frame, bus: &Bus, world: &World) -> Outcome {
        self.judge(Rule::OneFrameAtATime);
        self.wire.sent(now, frame)?;
        self.asked.sent(now, frame, bus);
        let raw = self.operator.raw_consent(frame);
        let limits = self.operator.limits;
        for rule in self.bounds.sent(now, frame, raw, limits, world)? {
            self.judge(rule);
        }
        match Request::parse(self.model, &frame) {
            Ok(Request::Drive { id, drive }) if raw.is_none() && drive.brakes() => {
                self.braked.insert(id);
                self.moves_no_more(now, world, |other| *other == id);
            }
            Ok(Request::Query { .. } | Request::ModeQuery { .. } | Request::IdQuery) => {}
            _ => self.braked.retain(|id| !may_obey(&frame, *id)),
        }
        let may_stop = self.operator.sent(now, frame, bus, world)?;
        if may_stop
            && let Ok(Request::Drive { id, .. } | Request::SwitchMode { id, .. }) =
                Request::parse(self.model, &frame)
        {
            self.rested.insert(id, now);
            if self.stops.remove(&id).is_some() {
                self.judge(Rule::StopIsNext);
            }
        } else {
            match Request::parse(self.model, &frame) {
                Ok(Request::Drive { id, .. }) => {
                    let by_hand = raw.is_some();
                    self.liveness.drives(now, id, by_hand)?;
                    let is_healthy = self.liveness.healthy_since().is_some();
                    if !by_hand && self.starts.drives(now, id, is_healthy, bus, world)? {
                        self.operator.first_driven(now, id);
                        // The brakes of its stop came before.
                        self.motion.asked(|other| *other == id);
                    }
                    self.judge(Rule::DrivenByCommandOnly);
                    self.judge(Rule::NoMoreThanCommanded);
                }
                Ok(Request::SetId { id }) => {
                    self.liveness.gets_address(id.id());
                    self.judge(Rule::IdChangeIsProved);
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The port refused or truncated a frame; `reported` is whether the bus knows.
    pub(crate) fn refused(&mut self, now: Instant, frame: Frame, bytes: usize, reported: bool) {
        self.wire.refused(now, frame, bytes, reported);
        self.asked.excused(now);
        self.liveness.disturbed();
        self.in_time.disturbed();
        // The bus counts a silently truncated frame as sent: the motor has had the first frame of its stop.
        if !reported
            && let Ok(request) = Request::parse(self.model, &frame)
            && let Request::Drive { id, .. } | Request::SwitchMode { id, .. } = request
        {
            self.stops.remove(&id);
            if may_stop(request) {
                self.rested.insert(id, now);
            }
        }
        // The bus sends another first.
        for until in self.stops.values_mut() {
            *until = *until + REFUSED_COSTS;
        }
    }

    /// The load of this wheel changed: the integral part of its controller may move it.
    pub(crate) fn loaded(&mut self, id: MotorId) {
        self.motion.loaded(id);
    }

    /// The motors have advanced to now.
    pub(crate) fn moved(&mut self, now: Instant, world: &World) -> Outcome {
        self.bounds.moved(world);
        self.motion.moved(now, world)
    }

    /// A motor replies, whether or not a port is open. An adapter may hold the reply until one is.
    pub(crate) fn said(&mut self, at: Instant, frame: Frame) {
        self.truth.replied(frame);
        self.invented.replied(at, frame);
    }

    /// A motor replies to an open port.
    pub(crate) fn replied(&mut self, at: Instant, frame: Frame, world: &World) {
        self.wire.replied(at, frame);
        self.bounds.replied(at, frame, world);
    }

    /// The bus gets bytes.
    pub(crate) fn delivered(&mut self, now: Instant, bytes: &[u8]) {
        self.bounds.delivered(now, bytes);
    }

    /// Time has passed.
    pub(crate) fn passed(&mut self, now: Instant, world: &World) -> Outcome {
        self.truth.passed(now, world);
        self.wire.passed(now)?;
        if let Some((id, until)) = self.stops.iter().find(|(_, until)| now > **until) {
            let what = format!("{id} has had no frame of its stop, due by {until:?}");
            return broken(Rule::StopIsNext, now, what);
        }
        if let Some(began) = self.stop_began
            && now.since(began) > STOP_ENDS_WITHIN
        {
            return broken(Rule::StopEnds, now, format!("it began at {began:?}"));
        }
        Ok(())
    }
}

/// Whether this may be a frame of a stop.
fn may_stop(request: Request) -> bool {
    match request {
        Request::Drive { drive, .. } => drive.brakes() || drive.signed() == 0,
        Request::SwitchMode { mode, .. } => mode == Mode::Velocity,
        _ => false,
    }
}

/// Whether this setpoint asks for motion.
fn turns(setpoint: Setpoint) -> bool {
    !matches!(setpoint, Setpoint::Velocity { speed, .. } if speed.rpm() == 0)
        && setpoint != Setpoint::Brake
}
