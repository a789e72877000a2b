//! Commands of the operator: which are in force, and what may be sent by them.

use std::{
    collections::{BTreeMap, BTreeSet},
    time::Duration,
};

use motorlink_bus::{
    Activity, Bus, Command, Consent, Event, Limits, LineEventKind, MotorStatus, OVERCURRENT_FOR,
    Refusal, Sample, StopReport, is_hazardous,
};
use motorlink_protocol::{
    Detail, Frame, Instant, Mode, MotorId, Setpoint,
    family::{Model, Request},
};
use motorlink_simulator::World;

use crate::rule::{Outcome, Rule, Violation, broken};

/// The motors of a silent page are stopped within this time.
const PAGE_SILENT_MAX: Duration = Duration::from_millis(1_100);
/// An older command starts nothing.
const COMMAND_AGE_MAX: Duration = Duration::from_millis(500);
/// How long the proof of a full scan lasts.
const PROOF_LIFETIME: Duration = Duration::from_secs(60);
/// A driven motor that is silent for longer loses its setpoint, after this many unanswered
/// requests; the next may be on its way.
const SILENCE_MAX: Duration = Duration::from_millis(200);
const UNANSWERED_MAX: u32 = 4;
/// Rounding of a current from one scale to another.
const ROUNDED_RAW: i32 = 1;
/// Overshoot of a wheel above its speed limit.
const OVERSHOOT_RPM: u16 = 10;

/// A command of the operator that is in force.
#[derive(Clone, Copy, Debug)]
struct Standing {
    setpoint: Setpoint,
    since: Instant,
}

/// Reports of a motor since driving began, as far as they decide whether it may stay driven.
#[derive(Clone, Copy, Debug, Default)]
struct Reported {
    last: Option<Instant>,
    /// Requests since then.
    asked: u32,
    overcurrent_since: Option<Instant>,
    /// The limit that it exceeded, and when the report arrived.
    exceeded: Option<(Instant, Limit)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Limit {
    Speed,
    Current,
    Temperature,
}

/// Inputs of the operator and the page.
#[derive(Debug, Default)]
pub(super) struct Operator {
    model: Model,
    standing: BTreeMap<MotorId, Standing>,
    reported: BTreeMap<MotorId, Reported>,
    pub(super) limits: Limits,
    page_silent_since: Option<Instant>,
    proof: Option<(MotorId, Instant)>,
    /// The requested ID change: from which ID to which.
    id_change: Option<(MotorId, MotorId)>,
    /// The raw frame that is still repeated, with its consent.
    raw: Option<(Frame, Consent)>,
    /// Motors whose setpoints ended with a late call, until the next one.
    withdrawn_by_gap: BTreeSet<MotorId>,
    /// Drive frames of this moment. They are judged when all events of it are out.
    driven_now: Vec<MotorId>,
}

impl Operator {
    pub(super) fn of(model: Model) -> Self {
        Self {
            model,
            ..Self::default()
        }
    }

    /// The bus answered a command.
    pub(super) fn on_command(
        &mut self,
        now: Instant,
        given: Instant,
        command: Command,
        answer: Result<(), Refusal>,
    ) -> Outcome {
        if answer.is_err() {
            return Ok(());
        }
        if command.may_move() && now.since(given) > COMMAND_AGE_MAX {
            let what = format!("{command:?} of {given:?} was taken");
            return broken(Rule::NoOldActs, now, what);
        }
        if let Command::Adjust { id, .. } = command
            && self.withdrawn_by_gap.contains(&id)
        {
            let what = format!("{id} is adjusted, and was withdrawn");
            return broken(Rule::GapWithdraws, now, what);
        }
        match command {
            Command::Drive { id, setpoint, .. } | Command::Adjust { id, setpoint, .. } => {
                self.stands(now, id, setpoint);
            }
            Command::DriveGroup { setpoints, .. } | Command::AdjustGroup { setpoints, .. } => {
                for (id, setpoint) in setpoints.entries() {
                    self.stands(now, id, setpoint);
                }
            }
            Command::SetId { from, to, .. } => self.id_change = Some((from, to.id())),
            Command::SwitchMode { id, .. } => {
                self.standing.remove(&id);
            }
            Command::Configure(settings) => self.limits = settings.limits,
            Command::SendRaw { frame, consent, .. } => self.raw = Some((frame, consent)),
            Command::StopRaw => self.raw = None,
            _ => {}
        }
        Ok(())
    }

    /// A command is in force from now on.
    pub(super) fn stands(&mut self, now: Instant, id: MotorId, setpoint: Setpoint) {
        let since = self.standing.get(&id).map_or(now, |before| before.since);
        if since == now {
            self.reported.insert(id, Reported::default());
        }
        self.standing.insert(id, Standing { setpoint, since });
        self.withdrawn_by_gap.remove(&id);
    }

    /// The first drive frame of a start that has waited: its silence counts from now on.
    pub(super) fn first_driven(&mut self, now: Instant, id: MotorId) {
        if let Some(standing) = self.standing.get_mut(&id) {
            standing.since = now;
        }
        self.reported.entry(id).or_default().asked = 0;
    }

    /// What is started after a confirmed stop begins at rest. Its motor may still be hot.
    pub(super) fn stopped(&mut self, report: &StopReport) {
        for outcome in report.motors.iter().filter(|outcome| outcome.confirmed) {
            if let Some(reported) = self.reported.get_mut(&outcome.id)
                && reported
                    .exceeded
                    .is_some_and(|(_, limit)| limit != Limit::Temperature)
            {
                reported.exceeded = None;
            }
        }
    }

    /// No call reached the bus for a while: the motors had nothing to answer. Their silence counts from now on.
    pub(super) fn was_away(&mut self) {
        for reported in self.reported.values_mut() {
            reported.asked = 0;
        }
    }

    /// A late call: no setpoint is in force any more. Returns whether one was.
    pub(super) fn was_late(&mut self) -> bool {
        let standing = self.standing.keys().copied();
        self.withdrawn_by_gap.extend(standing);
        let raw = self.raw.filter(|(frame, _)| is_hazardous(frame));
        if let Some((frame, _)) = raw {
            let [first, ..] = *frame.bytes();
            self.withdrawn_by_gap.extend(MotorId::new(first));
        }
        raw.is_some() || !self.standing.is_empty()
    }

    /// Motors with a command in force.
    pub(super) fn standing(&self) -> BTreeSet<MotorId> {
        self.standing.keys().copied().collect()
    }

    /// The raw frame that is still repeated.
    pub(super) fn raw(&self) -> Option<Frame> {
        self.raw.map(|(frame, _)| frame)
    }

    /// The consent, if this is the raw frame.
    pub(super) fn raw_consent(&self, frame: Frame) -> Option<Consent> {
        let (_, consent) = self.raw.filter(|(raw, _)| *raw == frame)?;
        Some(consent)
    }

    /// Ends the commands of these motors and returns the motors. A raw frame ends with any stop.
    pub(super) fn stop(&mut self, is_stopped: impl Fn(&MotorId) -> bool) -> (Vec<MotorId>, u32) {
        self.raw = None;
        let others = u32::try_from(self.standing.len()).unwrap_or(u32::MAX);
        let driven: Vec<MotorId> = self.standing.keys().copied().filter(is_stopped).collect();
        for id in &driven {
            self.standing.remove(id);
        }
        (driven, others)
    }

    /// A motor that the bus does not drive any more has no command in force. Only a new command
    /// changes that.
    pub(super) fn check_active_setpoints(&mut self, now: Instant, bus: &Bus) -> Outcome {
        for id in std::mem::take(&mut self.driven_now) {
            self.may_still_be_driven(now, id)?;
        }
        // A setpoint that waits for a stop or a mode switch is in force after it.
        let is_driven = |status: &MotorStatus| {
            let by_now = matches!(
                status.activity,
                Activity::Driven { .. } | Activity::Switching { .. }
            );
            by_now || status.waiting.is_some()
        };
        let driven: BTreeSet<MotorId> = bus
            .motors(now)
            .filter(is_driven)
            .map(|status| status.id)
            .collect();
        self.standing.retain(|id, _| driven.contains(id));
        self.raw = self
            .raw
            .filter(|_| bus.raw().is_some_and(|raw| raw.running));
        Ok(())
    }

    fn may_still_be_driven(&self, now: Instant, id: MotorId) -> Outcome {
        let Some(standing) = self.standing.get(&id) else {
            return Ok(());
        };
        let reported = self.reported.get(&id).copied().unwrap_or_default();
        let silent_since = reported
            .last
            .map_or(standing.since, |at| at.max(standing.since));
        if now.since(silent_since) > SILENCE_MAX && reported.asked > UNANSWERED_MAX {
            let what = format!("{id} is driven, and silent since {silent_since:?}");
            return broken(Rule::SilentIsWithdrawn, now, what);
        }
        // A frame of the same moment may have been sent before the reply arrived.
        if let Some((_, limit)) = reported.exceeded.filter(|(received, _)| *received < now) {
            let what = format!("{id} is driven beyond its limit: {limit:?}");
            return broken(Rule::LimitsHold, now, what);
        }
        Ok(())
    }

    /// Whether the page answers.
    pub(super) fn page(&mut self, now: Instant, answers: bool) {
        if answers {
            self.page_silent_since = None;
        } else {
            self.page_silent_since.get_or_insert(now);
        }
    }

    /// The port is closed: no command is in force. The page keeps the limits.
    pub(super) fn port_lost(&mut self) {
        let (silent, limits) = (self.page_silent_since, self.limits);
        *self = Self::of(self.model);
        self.page_silent_since = silent;
        self.limits = limits;
    }

    /// A frame goes out. Returns whether it may be a stop frame.
    pub(super) fn sent(
        &mut self,
        now: Instant,
        frame: Frame,
        bus: &Bus,
        world: &World,
    ) -> Result<bool, Violation> {
        let request = Request::parse(self.model, &frame);
        if let Ok(request) = request
            && let Some(id) = addressee(request)
            // A mode switch of a model with combined frames has no answer that could be missing.
            && request.reply_layout(self.model).is_some()
        {
            self.reported.entry(id).or_default().asked += 1;
        }
        if self.raw() == Some(frame) {
            return self.raw_goes_out(now, frame);
        }
        match request {
            Ok(Request::Drive { id, drive }) => {
                let rests = drive.brakes() || drive.signed() == 0;
                let in_position = world
                    .motor(id)
                    .is_some_and(|it| it.mode() == Mode::Position);
                if rests && (!in_position || drive.brakes()) {
                    return Ok(true);
                }
                self.drives(now, id, drive.signed(), drive.unsigned(), bus)?;
            }
            Ok(Request::SwitchMode { mode, .. }) => return Ok(mode == Mode::Velocity),
            Ok(Request::SetId { id: to }) => {
                let proved = self
                    .proof
                    .filter(|(_, at)| now.since(*at) <= PROOF_LIFETIME);
                let asked = self.id_change.filter(|(_, asked)| *asked == to.id());
                if asked.is_none() || proved.map(|(id, _)| id) != asked.map(|(from, _)| from) {
                    return broken(
                        Rule::IdChangeIsProved,
                        now,
                        "not asked for, or without a scan that proves it",
                    );
                }
            }
            Ok(
                Request::Query { .. }
                | Request::ModeQuery { .. }
                | Request::Enable { on: true, .. }
                | Request::IdQuery,
            ) => {}
            // The bus sends no other frame on its own.
            other => {
                let what = format!("{frame}: {other:?}");
                return broken(Rule::DrivenByCommandOnly, now, what);
            }
        }
        Ok(false)
    }

    /// A raw frame: any bytes, but not while the page hangs.
    fn raw_goes_out(&self, now: Instant, frame: Frame) -> Result<bool, Violation> {
        match self.page_silent_since {
            Some(since) if is_hazardous(&frame) && now.since(since) > PAGE_SILENT_MAX => {
                let what = format!("{frame} of a person, the page silent since {since:?}");
                broken(Rule::DeadPageStops, now, what)
            }
            _ => Ok(false),
        }
    }

    fn drives(&mut self, now: Instant, id: MotorId, signed: i16, raw: u16, bus: &Bus) -> Outcome {
        let Some(Standing { setpoint, .. }) = self.standing.get(&id) else {
            let what = format!("{id} to {signed}, and no command stands");
            let rule = if self.withdrawn_by_gap.contains(&id) {
                Rule::GapWithdraws
            } else {
                Rule::DrivenByCommandOnly
            };
            return broken(rule, now, what);
        };
        if let Some(since) = self.page_silent_since
            && now.since(since) > PAGE_SILENT_MAX
        {
            let what = format!("{id} to {signed}, the page silent since {since:?}");
            return broken(Rule::DeadPageStops, now, what);
        }
        self.driven_now.push(id);
        let within = |goal: i16| {
            let (low, high) = (goal.min(0), goal.max(0));
            (low..=high).contains(&signed)
        };
        let fits = match setpoint {
            // A ramp may not have reached it yet.
            Setpoint::Velocity { speed, .. } => {
                within(speed.rpm() * i16::from(self.model.spec().speed_units_per_rpm))
            }
            Setpoint::OpenLoop(target) => signed == target.raw() || signed == 0,
            Setpoint::Current(current) => {
                let off = i32::from(signed) - scaled(current.raw(), self.model);
                signed == 0 || off.abs() <= ROUNDED_RAW
            }
            Setpoint::Position(target) => raw == target.raw() || holds(id, raw, bus, now),
            Setpoint::Brake => false,
        };
        if fits {
            return Ok(());
        }
        let what = format!("{id} to {signed}, commanded {setpoint:?}");
        broken(Rule::NoMoreThanCommanded, now, what)
    }

    /// The bus reports an event.
    pub(super) fn on_event(&mut self, now: Instant, event: &Event) {
        match event {
            Event::Telemetry(sample) => self.reported(sample),
            Event::ScanEnded(report) => {
                self.proof = match report.found.as_slice() {
                    [only] if report.complete => Some((*only, now)),
                    _ => None,
                };
            }
            // A good reply shows that the motor answers, in any layout.
            Event::Line(traffic) => {
                if let LineEventKind::Received { frame, .. } = traffic.kind
                    && let [id, ..] = *frame.bytes()
                    && let Ok(id) = MotorId::new(id)
                {
                    let reported = self.reported.entry(id).or_default();
                    (reported.last, reported.asked) = (Some(traffic.at), 0);
                }
            }
            _ => {}
        }
    }

    fn reported(&mut self, sample: &Sample) {
        let Sample { at, reply } = sample;
        let Some(standing) = self.standing.get(&reply.id) else {
            return;
        };
        let reported = self.reported.entry(reply.id).or_default();
        if let Some(speed) = reply.speed
            && speed.magnitude() > self.limits.speed_rpm() + OVERSHOOT_RPM
        {
            reported.exceeded = reported.exceeded.or(Some((*at, Limit::Speed)));
        }
        let excess = reply.current.map(|current| {
            current.amps().abs() * 1_000.0 >= f32::from(self.limits.current_ma()) + 1.0
        });
        if excess == Some(false) {
            reported.overcurrent_since = None;
        } else if excess == Some(true) {
            let since = *reported.overcurrent_since.get_or_insert(*at);
            if at.since(since.max(standing.since)) >= OVERCURRENT_FOR {
                reported.exceeded = reported.exceeded.or(Some((*at, Limit::Current)));
            }
        }
        if let Detail::Query { temperature, .. } | Detail::Temperature(temperature) = reply.detail
            && u16::from(temperature.degrees()) > self.limits.temperature_c()
        {
            reported.exceeded = reported.exceeded.or(Some((*at, Limit::Temperature)));
        }
    }
}

fn addressee(request: Request) -> Option<MotorId> {
    match request {
        Request::Drive { id, .. } | Request::Query { id } | Request::SwitchMode { id, .. } => {
            Some(id)
        }
        _ => None,
    }
}

/// A current in the unit of a DDSM115, in that of this model. Both have full scale at 32,767.
fn scaled(raw: i16, model: Model) -> i32 {
    let full_scale_ma = |model: Model| i32::from(model.spec().current.milliamps());
    let scaled = i32::from(raw) * full_scale_ma(Model::Ddsm115) / full_scale_ma(model);
    // More than full scale cannot be asked for.
    scaled.clamp(-i32::from(i16::MAX), i16::MAX.into())
}

/// Hold: the angle of the wheel at that time.
fn holds(id: MotorId, raw: u16, bus: &Bus, now: Instant) -> bool {
    let status = bus.motors(now).find(|status| status.id == id);
    matches!(
        status.map(|status| status.activity),
        Some(Activity::Driven { setpoint: Setpoint::Position(held) }) if held.raw() == raw
    )
}
