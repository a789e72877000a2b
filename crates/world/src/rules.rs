//! What must hold after every step, each rule with its name.
//!
//! | file | idea |
//! |---|---|
//! | `operator` | what was asked for, what stands of it, what may be sent by it |
//! | `wire` | what passes on the wire, and what the log has of it |
//! | `truth` | whether what is told is true of the motors |

mod operator;
mod truth;
mod wire;

use std::{collections::BTreeMap, fmt, time::Duration};

use motorlink_bus::{
    Bus, Command, Event, Limits, Passed, Refusal, StopReason, StopReport, WithdrawReason,
};
use motorlink_protocol::{Frame, Instant, MotorId, Request};
use motorlink_simulator::World;

use self::{operator::Operator, truth::Truth, wire::Wire};

/// What a stop may take to reach a motor: 10 ms of bus time, and the exchange in flight, which it waits
/// for at most 10 ms.
const STOP_REACHES_WITHIN: Duration = Duration::from_millis(20);
/// A motor that does not answer costs those behind it its window.
const WINDOW_MAX: Duration = Duration::from_millis(40);
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
}

impl Rule {
    /// All of them.
    pub const ALL: [Self; 14] = [
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
    ) -> Outcome {
        self.operator.commanded(now, given, command, answer)?;
        if answer.is_ok() {
            match command {
                // One that joins another has a window of its own.
                Command::Stop(id) => {
                    self.stop_begins(now, |other| *other == id);
                    self.stop_began = self.stop_began.map(|_| now);
                }
                Command::StopAll(_) => {
                    self.stop_begins(now, |_| true);
                    self.stop_began = Some(now);
                }
                _ => {}
            }
        }
        self.keep_what_stands(now, bus)
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
            let until = now + STOP_REACHES_WITHIN + WINDOW_MAX * others;
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
    pub(crate) fn port_lost(&mut self) {
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

    /// A motor replies.
    pub(crate) fn replied(&mut self, at: Instant, frame: Frame) {
        self.wire.replied(at, frame);
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
            }
            Event::Telemetry(_) => self.judge(Rule::TelemetryIsTrue),
            Event::Traffic(traffic) => self.judge(match traffic.passed {
                Passed::Heard { .. } => Rule::GoodRepliesAreHeard,
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
