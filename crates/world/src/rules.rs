//! What must hold after every step, each rule with its name.

use std::{
    collections::{BTreeMap, VecDeque},
    fmt,
    time::Duration,
};

use motorlink_bus::{Activity, Bus, Command, Event, Passed, Refusal};
use motorlink_protocol::{Detail, Frame, Instant, Mode, MotorId, Request, Setpoint};
use motorlink_simulator::World;

/// A frame of ten bytes at 115200 baud.
const AIRTIME: Duration = Duration::from_micros(868);
/// What a stop may take to reach a motor: 10 ms of bus time, and the exchange in flight, which it waits
/// for at most 10 ms.
const STOP_REACHES_WITHIN: Duration = Duration::from_millis(20);
/// A motor that does not answer costs those behind it its window.
const WINDOW_MAX: Duration = Duration::from_millis(40);
/// A stop ends confirmed or with the end of its window, three seconds; scans and switches are over then.
const STOP_ENDS_WITHIN: Duration = Duration::from_secs(4);
/// A page that does not answer has its motors stopped.
const PAGE_SILENT_MAX: Duration = Duration::from_millis(1_100);
/// A sensor's step, noise, and the time that a reply was held.
const TEMPERATURE_OFF_MAX_C: f32 = 4.0;
/// A reply speaks of no earlier moment than this.
const REPLY_HELD_MAX: Duration = Duration::from_millis(250);
/// A full scan proves for so long who is there.
const PROOF_LASTS: Duration = Duration::from_secs(60);

/// A rule's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rule {
    /// A wheel is driven only while an operator's command for it stands.
    DrivenByCommandOnly,
    /// What is sent lies between rest and what was commanded.
    NoMoreThanCommanded,
    /// A stop reaches every driven motor in time.
    StopIsNext,
    /// A stop ends, confirmed or not.
    StopEnds,
    /// A hung page has its motors stopped.
    DeadPageStops,
    /// What is told was measured in that layout, from that motor.
    TelemetryIsTrue,
    /// Two frames are never on the wire at once.
    OneFrameAtATime,
    /// No ID is changed but on the proof of a full scan.
    IdChangeIsProved,
    /// Every frame sent is in the log, in order.
    LogIsComplete,
    /// No panic, no busy loop, and rest in the end.
    ComesToRest,
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

/// What the rules know of the world beside what they are shown.
#[derive(Debug, Default)]
pub(crate) struct Rules {
    /// Commands that stand, and the greatest that was commanded since the wheel was driven.
    standing: BTreeMap<MotorId, Setpoint>,
    /// Who has to get a frame of a stop, and until when.
    stops: BTreeMap<MotorId, Instant>,
    stop_began: Option<Instant>,
    page_silent_since: Option<Instant>,
    last_sent: Option<Instant>,
    unlogged: VecDeque<Frame>,
    proof: Option<(MotorId, Instant)>,
    /// What the operator asked for: from which ID to which.
    id_change: Option<(MotorId, MotorId)>,
    /// When a motor's temperature was last changed by more than nature does.
    heated: Option<Instant>,
}

type Outcome = Result<(), Violation>;

fn broken<T>(rule: Rule, at: Instant, what: impl Into<String>) -> Result<T, Violation> {
    let what = what.into();
    Err(Violation { rule, at, what })
}

impl Rules {
    /// The operator asked for something, and the bus answered.
    pub(crate) fn commanded(
        &mut self,
        now: Instant,
        command: Command,
        answer: Result<(), Refusal>,
        bus: &Bus,
    ) {
        if answer.is_err() {
            return;
        }
        match command {
            Command::Drive { id, setpoint, .. } | Command::Adjust { id, setpoint, .. } => {
                self.standing.insert(id, setpoint);
            }
            Command::DriveTogether { parts, .. } | Command::AdjustTogether { parts, .. } => {
                self.standing.extend(parts.parts());
            }
            Command::SetId { from, to } => self.id_change = Some((from, to.id())),
            Command::SwitchMode { id, .. } => {
                self.standing.remove(&id);
            }
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
        self.keep_what_stands(now, bus);
    }

    fn stop_begins(&mut self, now: Instant, is_stopped: impl Fn(&MotorId) -> bool) {
        let driven: Vec<MotorId> = self.standing.keys().copied().filter(is_stopped).collect();
        let others = u32::try_from(self.standing.len()).unwrap_or(u32::MAX);
        for id in driven {
            self.standing.remove(&id);
            let until = now + STOP_REACHES_WITHIN + WINDOW_MAX * others;
            self.stops.entry(id).or_insert(until);
        }
    }

    /// What the bus drives no more is driven by nobody's command any more, and only a new one can
    /// change that.
    pub(crate) fn keep_what_stands(&mut self, now: Instant, bus: &Bus) {
        let driven: BTreeMap<MotorId, Activity> = bus
            .motors(now)
            .map(|status| (status.id, status.activity))
            .collect();
        // What was asked for during a mode switch stands behind it.
        self.standing.retain(|id, _| {
            let activity = driven.get(id);
            matches!(
                activity,
                Some(Activity::Driven { .. } | Activity::Switching { .. })
            )
        });
    }

    /// The page answers, or does not.
    pub(crate) fn page(&mut self, now: Instant, answers: bool) {
        if answers {
            self.page_silent_since = None;
        } else {
            self.page_silent_since.get_or_insert(now);
        }
    }

    /// A motor is as hot at once as it would be in minutes.
    pub(crate) fn heated(&mut self, now: Instant) {
        self.heated = Some(now);
    }

    /// The port is gone, and with it whatever stood.
    pub(crate) fn port_lost(&mut self) {
        let silent = self.page_silent_since;
        *self = Self::default();
        self.page_silent_since = silent;
    }

    /// A frame goes out.
    pub(crate) fn sent(&mut self, now: Instant, frame: Frame, bus: &Bus, world: &World) -> Outcome {
        if self.last_sent.is_some_and(|last| now < last + AIRTIME) {
            return broken(Rule::OneFrameAtATime, now, format!("{frame}"));
        }
        self.last_sent = Some(now);
        self.unlogged.push_back(frame);
        match Request::parse(&frame) {
            Ok(Request::Drive { id, drive }) => {
                let rests = drive.brakes() || drive.signed() == 0;
                let in_position = world
                    .motor(id)
                    .is_some_and(|it| it.mode() == Mode::Position);
                if !rests || (in_position && !drive.brakes()) {
                    self.drives(now, id, drive.signed(), drive.unsigned(), bus)?;
                } else {
                    self.stops.remove(&id);
                }
            }
            Ok(Request::SwitchMode { id, mode }) => {
                if mode == Mode::Velocity {
                    self.stops.remove(&id);
                }
            }
            Ok(Request::SetId { id: to }) => {
                let proved = self.proof.filter(|(_, at)| now.since(*at) <= PROOF_LASTS);
                let asked = self.id_change.filter(|(_, asked)| *asked == to.id());
                if asked.is_none() || proved.map(|(id, _)| id) != asked.map(|(from, _)| from) {
                    return broken(
                        Rule::IdChangeIsProved,
                        now,
                        "not asked for, or without a scan that proves it",
                    );
                }
            }
            Ok(Request::Query { .. } | Request::IdQuery) => {}
            // Nobody in this world writes frames by hand.
            other => {
                return broken(
                    Rule::DrivenByCommandOnly,
                    now,
                    format!("{frame}: {other:?}"),
                );
            }
        }
        Ok(())
    }

    fn drives(&self, now: Instant, id: MotorId, signed: i16, raw: u16, bus: &Bus) -> Outcome {
        let Some(setpoint) = self.standing.get(&id) else {
            let what = format!("{id} to {signed}, and no command stands");
            return broken(Rule::DrivenByCommandOnly, now, what);
        };
        if let Some(since) = self.page_silent_since
            && now.since(since) > PAGE_SILENT_MAX
        {
            let what = format!("{id} to {signed}, the page silent since {since:?}");
            return broken(Rule::DeadPageStops, now, what);
        }
        let within = |goal: i16| {
            let (low, high) = (goal.min(0), goal.max(0));
            (low..=high).contains(&signed)
        };
        let fits = match setpoint {
            // A ramp may still be on its way there.
            Setpoint::Velocity { speed, .. } => within(speed.rpm()),
            Setpoint::Current(current) => signed == current.raw() || signed == 0,
            Setpoint::Position(target) => raw == target.raw() || holds(id, raw, bus, now),
            Setpoint::Brake => false,
        };
        if fits {
            return Ok(());
        }
        let what = format!("{id} to {signed}, commanded {setpoint:?}");
        broken(Rule::NoMoreThanCommanded, now, what)
    }

    /// The bus tells something.
    pub(crate) fn told(&mut self, now: Instant, event: &Event, world: &World) -> Outcome {
        match event {
            Event::Traffic(traffic) => {
                if let Passed::Sent { frame, .. } = traffic.passed
                    && self.unlogged.pop_front() != Some(frame)
                {
                    return broken(Rule::LogIsComplete, now, format!("{frame} out of turn"));
                }
            }
            Event::Telemetry(sample) => {
                let reply = sample.reply;
                let Some(motor) = world.motor(reply.id) else {
                    return Ok(());
                };
                let in_flight = self.heated.is_some_and(|at| now.since(at) < REPLY_HELD_MAX);
                if let Detail::Query { temperature, .. } = reply.detail
                    && !in_flight
                {
                    let (read, truth) = (f32::from(temperature.degrees()), motor.temperature_c());
                    if (read - truth).abs() > TEMPERATURE_OFF_MAX_C {
                        let what = format!("{} reads {read} for {truth} degrees", reply.id);
                        return broken(Rule::TelemetryIsTrue, now, what);
                    }
                }
            }
            Event::StopBegan(_) => self.stop_began = Some(now),
            Event::StopEnded(_) => self.stop_began = None,
            Event::ScanEnded(report) => {
                self.proof = match report.found.as_slice() {
                    [only] if report.complete => Some((*only, now)),
                    _ => None,
                };
            }
            _ => {}
        }
        Ok(())
    }

    /// Time has passed.
    pub(crate) fn passed(&self, now: Instant) -> Outcome {
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

/// Hold: the angle at which it was.
fn holds(id: MotorId, raw: u16, bus: &Bus, now: Instant) -> bool {
    let status = bus.motors(now).find(|status| status.id == id);
    matches!(
        status.map(|status| status.activity),
        Some(Activity::Driven { setpoint: Setpoint::Position(held) }) if held.raw() == raw
    )
}
