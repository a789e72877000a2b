//! What must hold after every step, each rule with its name.
//!
//! | file | idea |
//! |---|---|
//! | `operator` | what was asked for, what stands of it, what may be sent by it |
//! | `wire` | what passes on the wire, and what the log has of it |
//! | `truth` | whether what is told is true of the motors |
//! | `motion` | whether a wheel moves on behind a stop or a hold |
//! | `bounds` | what may be on the wire at all |

mod bounds;
mod motion;
mod operator;
mod truth;
mod wire;

use std::{collections::BTreeMap, fmt, time::Duration};

use motorlink_bus::{
    Bus, Command, Event, Limits, LineEventKind, Refusal, StopReason, StopReport, WithdrawReason,
    is_hazardous,
};
use motorlink_protocol::{Frame, Instant, MotorId, Request};
use motorlink_simulator::World;

use self::{bounds::Bounds, motion::Motion, operator::Operator, truth::Truth, wire::Wire};

/// What a stop may take to reach a motor: 10 ms of bus time, and the exchange in flight, which it waits
/// for at most 10 ms.
const STOP_REACHES_WITHIN: Duration = Duration::from_millis(20);
/// A motor that does not answer costs those behind it its window.
const WINDOW_MAX: Duration = Duration::from_millis(40);
/// A frame that the port did not take costs its window, and what is sent then its airtime.
const REFUSED_COSTS: Duration = Duration::from_millis(45);
/// A stop ends confirmed or with the end of its window, three seconds; scans and switches are over then.
const STOP_ENDS_WITHIN: Duration = Duration::from_secs(4);

/// A rule's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rule {
    /// A wheel is driven only while an operator's command for it stands.
    DrivenByCommandOnly,
    /// An act that comes late starts nothing.
    NoOldActs,
    /// What is sent lies between rest and what was commanded.
    NoMoreThanCommanded,
    /// A motor that is silent for 200 ms loses its setpoint.
    SilentIsWithdrawn,
    /// A motor that crosses a limit is driven no more.
    LimitsHold,
    /// A stop reaches every driven motor in time.
    StopIsNext,
    /// A stop ends, and says truly of each motor whether it stands.
    StopEnds,
    /// A hung page has its motors stopped.
    DeadPageStops,
    /// What is told was measured in that layout, from that motor.
    TelemetryIsTrue,
    /// Two frames are never on the wire at once.
    OneFrameAtATime,
    /// On a good line every reply is heard, whatever came before.
    GoodRepliesAreHeard,
    /// No ID is changed but on the proof of a full scan.
    IdChangeIsProved,
    /// Every frame sent, and every one that was read, is in the log, in order.
    LogIsComplete,
    /// No panic, no busy loop, and rest in the end.
    ComesToRest,
    /// What stood before the bus was called late stands no more.
    GapWithdraws,
    /// A wheel that is stopped turns no further than its momentum carries it.
    StopMovesNothing,
    /// A wheel that is held goes no further.
    HoldHolds,
    /// No frame asks for more than a limit, in any loop that its motor may be in.
    NothingAboveALimit,
    /// A torque is reversed only behind a zero that the motor has answered.
    ReversalPassesZero,
}

impl Rule {
    /// All of them.
    pub const ALL: [Self; 19] = [
        Self::DrivenByCommandOnly,
        Self::NoOldActs,
        Self::NoMoreThanCommanded,
        Self::SilentIsWithdrawn,
        Self::LimitsHold,
        Self::StopIsNext,
        Self::StopEnds,
        Self::DeadPageStops,
        Self::TelemetryIsTrue,
        Self::OneFrameAtATime,
        Self::GoodRepliesAreHeard,
        Self::IdChangeIsProved,
        Self::LogIsComplete,
        Self::ComesToRest,
        Self::GapWithdraws,
        Self::StopMovesNothing,
        Self::HoldHolds,
        Self::NothingAboveALimit,
        Self::ReversalPassesZero,
    ];
}

/// A rule that did not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// Which.
    pub rule: Rule,
    /// When, on the world's clock.
    pub at: Instant,
    /// What happened.
    pub what: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} at {:?}: {}", self.rule, self.at, self.what)
    }
}

/// Whether a motor may obey a frame, by its first byte; all hear what is for 0xC8.
fn hears(frame: &Frame, id: MotorId) -> bool {
    let [first, ..] = *frame.bytes();
    first == id.get() || first == 0xC8
}

type Outcome = Result<(), Violation>;

fn broken<T>(rule: Rule, at: Instant, what: impl Into<String>) -> Result<T, Violation> {
    let what = what.into();
    Err(Violation { rule, at, what })
}

/// What the rules know of the world beside what they are shown.
#[derive(Debug, Default)]
pub(crate) struct Rules {
    operator: Operator,
    wire: Wire,
    truth: Truth,
    motion: Motion,
    bounds: Bounds,
    /// Who has to get a frame of a stop, and until when.
    stops: BTreeMap<MotorId, Instant>,
    /// When each motor got its last frame that a stop may consist of.
    rested: BTreeMap<MotorId, Instant>,
    /// Who has to be in the report of the stop.
    reported: Vec<MotorId>,
    stop_began: Option<Instant>,
    /// How often each rule had something to judge: one that never has would hold whatever happens.
    pub(crate) judged: BTreeMap<Rule, u64>,
}

impl Rules {
    pub(crate) fn judge(&mut self, rule: Rule) {
        *self.judged.entry(rule).or_default() += 1;
    }

    /// The operator asked for something at `given`, and the bus answered now.
    pub(crate) fn commanded(
        &mut self,
        now: Instant,
        given: Instant,
        command: Command,
        answer: Result<(), Refusal>,
        bus: &Bus,
        world: &World,
    ) -> Outcome {
        let raw = self.operator.raw();
        self.operator.commanded(now, given, command, answer)?;
        match answer {
            Ok(()) => self.carried_out(now, command, raw, world),
            Err(Refusal::AboveSpeedLimit(_) | Refusal::NeedsConsent(_)) => {
                self.judge(Rule::NothingAboveALimit);
            }
            Err(_) => {}
        }
        self.keep_what_stands(now, bus)
    }

    /// The bus carries it out; `raw` is what a person's frame was before.
    fn carried_out(&mut self, now: Instant, command: Command, raw: Option<Frame>, world: &World) {
        match command {
            // One that joins another has a window of its own.
            Command::Stop(id) => {
                self.stop_begins(now, |other| *other == id);
                self.stop_began = self.stop_began.map(|_| now);
                self.moves_no_more(now, world, |other| *other == id);
            }
            Command::StopAll(_) => {
                self.stop_begins(now, |_| true);
                self.stop_began = Some(now);
                self.moves_no_more(now, world, |_| true);
            }
            Command::StopRaw => {
                let standing = self.operator.standing();
                self.moves_no_more(now, world, |id| {
                    !standing.contains(id) && raw.is_some_and(|raw| hears(&raw, *id))
                });
            }
            Command::Drive { id, consent, .. } | Command::Adjust { id, consent, .. } => {
                self.motion.asked(|other| *other == id);
                self.bounds.commanded(id, consent);
            }
            Command::DriveGroup {
                setpoints: parts,
                consent,
            }
            | Command::AdjustGroup {
                setpoints: parts,
                consent,
            } => {
                for (id, _) in parts.parts() {
                    self.motion.asked(|other| *other == id);
                    self.bounds.commanded(id, consent);
                }
            }
            Command::SendRaw { frame, .. } if is_hazardous(&frame) => {
                self.motion.asked(|id| hears(&frame, *id));
            }
            Command::Hold(id) if self.motion.hold(now, id, world) => self.judge(Rule::HoldHolds),
            _ => {}
        }
    }

    /// These were stopped: whatever moves them now was not asked for.
    fn moves_no_more(
        &mut self,
        now: Instant,
        world: &World,
        is_stopped: impl Fn(&MotorId) -> bool,
    ) {
        let judged = self.motion.stop(now, world, is_stopped);
        *self.judged.entry(Rule::StopMovesNothing).or_default() += judged;
    }

    /// Nobody called the bus for a while: `is_late` is whether for too long.
    pub(crate) fn was_away(&mut self, now: Instant, is_late: bool, world: &World) {
        self.wire.disturbed(now);
        self.stop_began = self.stop_began.map(|_| now);
        if is_late {
            if self.operator.was_late() {
                self.judge(Rule::GapWithdraws);
            }
            self.stop_begins(now, |_| true);
            self.moves_no_more(now, world, |_| true);
        } else {
            // What a motor said before is heard this late.
            self.truth.was_away();
        }
        let others = u32::try_from(self.stops.len()).unwrap_or(u32::MAX);
        for until in self.stops.values_mut() {
            *until = now + STOP_REACHES_WITHIN + WINDOW_MAX * others;
        }
    }

    fn stop_begins(&mut self, now: Instant, is_stopped: impl Fn(&MotorId) -> bool) {
        let (driven, others) = self.operator.stop(is_stopped);
        for id in driven {
            self.reported.push(id);
            // A stop that the bus begins is told behind its first frame.
            if self.rested.get(&id) == Some(&now) {
                self.judge(Rule::StopIsNext);
                continue;
            }
            // Those whose stop began a moment ago come first, each with its window.
            let waiting = u32::try_from(self.stops.len()).unwrap_or(u32::MAX);
            let before = others.saturating_add(waiting);
            let until = now + STOP_REACHES_WITHIN + WINDOW_MAX * before;
            self.stops.entry(id).or_insert(until);
        }
    }

    /// All that was heard at this moment is told.
    pub(crate) fn settled(&mut self, now: Instant, bus: &Bus) -> Outcome {
        self.wire.settled(now)?;
        self.keep_what_stands(now, bus)
    }

    fn keep_what_stands(&mut self, now: Instant, bus: &Bus) -> Outcome {
        self.operator.keep_what_stands(now, bus)
    }

    /// The page answers, or does not.
    pub(crate) fn page(&mut self, now: Instant, answers: bool) {
        self.operator.page(now, answers);
    }

    /// A new bus is told the limits.
    pub(crate) fn limits(&mut self, limits: Limits) {
        self.operator.limits = limits;
    }

    /// A motor is as hot at once as it would be in minutes.
    pub(crate) fn heated(&mut self, now: Instant) {
        self.truth.heated(now);
    }

    /// The line becomes good, or bad.
    pub(crate) fn line(&mut self, now: Instant, is_good: bool) {
        self.wire.line(now, is_good);
    }

    /// The port is gone, and with it whatever stood.
    pub(crate) fn port_lost(&mut self, now: Instant, world: &World) {
        self.moves_no_more(now, world, |_| true);
        self.bounds.port_lost();
        self.operator.port_lost();
        self.wire.port_lost();
        self.stops.clear();
        self.reported.clear();
        self.stop_began = None;
    }

    /// A frame goes out.
    pub(crate) fn sent(&mut self, now: Instant, frame: Frame, bus: &Bus, world: &World) -> Outcome {
        self.judge(Rule::OneFrameAtATime);
        self.wire.sent(now, frame)?;
        let raw = self.operator.raw_consent(frame);
        let limits = self.operator.limits;
        for rule in self.bounds.sent(now, frame, raw, limits, world)? {
            self.judge(rule);
        }
        if let (None, Ok(Request::Drive { id, drive })) = (raw, Request::parse(&frame))
            && drive.brakes()
        {
            self.moves_no_more(now, world, |other| *other == id);
        }
        let may_stop = self.operator.sent(now, frame, bus, world)?;
        if may_stop
            && let Ok(Request::Drive { id, .. } | Request::SwitchMode { id, .. }) =
                Request::parse(&frame)
        {
            self.rested.insert(id, now);
            if self.stops.remove(&id).is_some() {
                self.judge(Rule::StopIsNext);
            }
        } else {
            match Request::parse(&frame) {
                Ok(Request::Drive { .. }) => {
                    self.judge(Rule::DrivenByCommandOnly);
                    self.judge(Rule::NoMoreThanCommanded);
                }
                Ok(Request::SetId { .. }) => self.judge(Rule::IdChangeIsProved),
                _ => {}
            }
        }
        Ok(())
    }

    /// The port refused a frame, or sent only its front; `told` is whether the bus knows.
    pub(crate) fn refused(&mut self, now: Instant, frame: Frame, bytes: usize, told: bool) {
        self.wire.refused(now, frame, bytes, told);
        // Until the bus sends another.
        for until in self.stops.values_mut() {
            *until = *until + REFUSED_COSTS;
        }
    }

    /// Something holds this wheel, or lets it go: what its controller has built up against it comes out.
    pub(crate) fn loaded(&mut self, id: MotorId) {
        self.motion.loaded(id);
    }

    /// The motors have come to this moment.
    pub(crate) fn moved(&mut self, now: Instant, world: &World) -> Outcome {
        self.bounds.moved(world);
        self.motion.moved(now, world)
    }

    /// A motor replies.
    pub(crate) fn replied(&mut self, at: Instant, frame: Frame, world: &World) {
        self.wire.replied(at, frame);
        self.truth.replied(frame);
        self.bounds.replied(at, frame, world);
    }

    /// Bytes are handed to the bus.
    pub(crate) fn delivered(&mut self, now: Instant, bytes: &[u8]) {
        self.bounds.delivered(now, bytes);
    }

    /// The bus tells something.
    pub(crate) fn told(&mut self, now: Instant, event: &Event, world: &World) -> Outcome {
        self.operator.told(now, event);
        self.wire.told(now, event)?;
        self.truth.told(now, event, world)?;
        match event {
            Event::StopBegan(reason) => {
                self.stop_began = Some(now);
                if *reason == StopReason::PageSilent {
                    self.judge(Rule::DeadPageStops);
                    self.stop_begins(now, |_| true);
                    self.moves_no_more(now, world, |_| true);
                }
            }
            Event::StopEnded(report) => {
                self.stop_began = None;
                self.judge(Rule::StopEnds);
                return self.names_all(now, report);
            }
            Event::Withdrawn { id, reason } => {
                match reason {
                    WithdrawReason::Silent => self.judge(Rule::SilentIsWithdrawn),
                    WithdrawReason::Limit(_) => self.judge(Rule::LimitsHold),
                    WithdrawReason::Fault(_) | WithdrawReason::OtherLoop { .. } => {}
                }
                self.stop_begins(now, |other| other == id);
                self.moves_no_more(now, world, |other| other == id);
            }
            Event::Telemetry(_) => self.judge(Rule::TelemetryIsTrue),
            Event::Line(traffic) => self.judge(match traffic.kind {
                LineEventKind::Received { .. } => Rule::GoodRepliesAreHeard,
                _ => Rule::LogIsComplete,
            }),
            _ => {}
        }
        Ok(())
    }

    fn names_all(&mut self, now: Instant, report: &StopReport) -> Outcome {
        let named = |id: &MotorId| report.motors.iter().any(|outcome| outcome.id == *id);
        let left_out = self.reported.drain(..).find(|id| !named(id));
        match left_out {
            Some(id) => broken(Rule::StopEnds, now, format!("{id} is not in the report")),
            None => Ok(()),
        }
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
