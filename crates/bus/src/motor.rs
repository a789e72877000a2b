//! State of one motor: what the bus knows of it and does with it.

use std::time::Duration;

use motorlink_protocol::{
    Celsius, Current, Instant, Mode, MotorId, Position, Reply, Rpm, family::Model,
};

use crate::{
    angle_estimate::AngleEstimate,
    angle_filter::AngleFilter,
    counters::{Counters, LossMeter, MissedRounds},
    late_replies::LateReplies,
    limits::{ExceededLimit, Limits, Overcurrent},
    mode_switch::Switch,
    model::separate::Separate,
    motor_status::Answer,
    rate::RateMeter,
    round_trip::RoundTrip,
    sample::Sample,
    silence::Silence,
    standstill::Standstill,
    stop::Stopping,
    temperature_filter::TemperatureFilter,
    torque::Torque,
    turning_unasked::TurningUnasked,
    turns::TurnCounter,
};

mod asking;
mod driven;
mod known;
mod loops;
mod replying;
mod rest;

pub(crate) use driven::Driven;
pub(crate) use rest::Rest;

/// What the bus does with a motor.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Control {
    /// Only queries.
    Idle,
    Switching(Switch),
    Driven(Driven),
    Stopping(Stopping),
}

/// A mode switch that no reply has confirmed yet.
#[derive(Clone, Copy, Debug)]
struct Switched {
    to: Mode,
    /// The replies that may arrive first and report the time before it.
    outstanding: usize,
    /// Whether another loop was asked for just before: then those replies may report any.
    among_others: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct Motor {
    pub(crate) id: MotorId,
    pub(crate) model: Model,
    pub(crate) separate: Separate,
    pub(crate) control: Control,
    /// Whether a command of this bus may still turn it.
    pub(crate) rest: Rest,
    /// Whether a raw frame may have moved it since its last stop.
    pub(crate) moved_raw: bool,
    /// The loop that an earlier connection left it in, until it answers.
    pub(crate) left_in: Option<Mode>,
    turning_unasked: TurningUnasked,
    last: Option<Sample>,
    /// When it last answered.
    answered: Option<Instant>,
    /// When it last told anything of its wheel.
    told: Option<Instant>,
    speed: Option<(Instant, Rpm)>,
    current: Option<(Instant, Current)>,
    position: Option<(Instant, Position)>,
    temperature: Option<(Instant, Celsius)>,
    turns: TurnCounter,
    overcurrent: Overcurrent,
    /// The first limit that a reply has exceeded since driving began.
    exceeded: Option<ExceededLimit>,
    watched_since: Instant,
    pub(crate) answer: Answer,
    pub(crate) late: LateReplies,
    temperature_filter: TemperatureFilter,
    angle_filter: AngleFilter,
    pub(crate) standstill: Standstill,
    pub(crate) angle_estimate: AngleEstimate,
    pub(crate) torque: Torque,
    /// How long the computer has stalled since the last reply.
    pub(crate) stalled: Duration,
    /// Requests since the last reply.
    pub(crate) unanswered_in_a_row: u32,
    /// The same, without the requests to other motors that stood for its drive frames.
    pub(crate) lost_in_a_row: u32,
    /// Which of the last eight of them had invalid bytes in their reply window: a bit each, the newest the lowest.
    garbled_windows: u8,
    /// The loop of a mode switch that no reply has confirmed yet.
    switched_to: Option<Switched>,
    /// The loop that a reply of unknown age has reported since the last reading, if it is another one.
    other_loop: Option<Mode>,
    pub(crate) next_query: Instant,
    /// Queries since it fell silent, while other motors are driven.
    silent_queries: u32,
    pub(crate) counters: Counters,
    pub(crate) missed_drives: MissedRounds,
    pub(crate) missed_queries: MissedRounds,
    pub(crate) round_trip: RoundTrip,
    pub(crate) loss: LossMeter,
    pub(crate) drive_frames: RateMeter,
}

impl Motor {
    pub(crate) fn new(now: Instant, model: Model, id: MotorId) -> Self {
        Self {
            id,
            model,
            separate: Separate::default(),
            control: Control::Idle,
            rest: Rest::Known,
            moved_raw: false,
            left_in: None,
            turning_unasked: TurningUnasked::default(),
            last: None,
            answered: None,
            told: None,
            speed: None,
            current: None,
            position: None,
            temperature: None,
            turns: TurnCounter::default(),
            overcurrent: Overcurrent::default(),
            exceeded: None,
            watched_since: now,
            answer: Answer::Comes,
            late: LateReplies::default(),
            temperature_filter: TemperatureFilter::default(),
            angle_filter: AngleFilter::default(),
            standstill: Standstill::default(),
            angle_estimate: AngleEstimate::default(),
            torque: Torque::default(),
            stalled: Duration::ZERO,
            unanswered_in_a_row: 0,
            lost_in_a_row: 0,
            garbled_windows: 0,
            switched_to: None,
            other_loop: None,
            next_query: now,
            silent_queries: 0,
            counters: Counters::default(),
            missed_drives: MissedRounds::default(),
            missed_queries: MissedRounds::default(),
            round_trip: RoundTrip::new(),
            loss: LossMeter::default(),
            drive_frames: RateMeter::default(),
        }
    }

    /// Records a reply. Returns whether the motor was silent before.
    pub(crate) fn record_reply(&mut self, at: Instant, reply: Reply, limits: Limits) -> bool {
        let sample = Sample { at, reply };
        self.last = Some(sample);
        self.stalled = Duration::ZERO;
        if self.is_free() {
            self.turning_unasked.record(&reply);
        } else {
            self.turning_unasked.clear();
        }
        self.overcurrent.record(sample, limits);
        if let Control::Driven(driven) = self.control {
            let exceeded = limits.exceeded(sample, None, self.overcurrent, driven.since);
            self.exceeded = self.exceeded.or(exceeded);
        }
        self.other_loop = None;
        self.count_reply();
        self.turns.record(at, &reply);
        self.speed = reply.speed.map(|speed| (at, speed)).or(self.speed);
        self.current = reply.current.map(|current| (at, current)).or(self.current);
        let (position, temperature) = (reply.detail.fine(), reply.detail.temperature());
        self.position = position.map(|position| (at, position)).or(self.position);
        self.temperature = temperature
            .map(|temperature| (at, temperature))
            .or(self.temperature);
        self.tells(at)
    }

    /// Records that it told something of its wheel. Returns whether it was silent before.
    pub(crate) fn tells(&mut self, at: Instant) -> bool {
        self.told = Some(at);
        self.request_answered(at);
        let was_silent = self.answer.is_silent();
        if was_silent {
            // While it was silent it was asked more and more rarely.
            self.next_query = self.next_query.min(at);
        }
        self.answer = Answer::Comes;
        was_silent
    }

    /// Records that it answers, even if it tells nothing of its wheel.
    pub(crate) fn request_answered(&mut self, at: Instant) {
        self.answered = Some(at);
        self.unanswered_in_a_row = 0;
        self.lost_in_a_row = 0;
        self.garbled_windows = 0;
    }

    /// Records a reply of unknown age: one less is outstanding, and it is no current reading. But replies arrive
    /// in order: if it reports another loop than the last reading, the motor has been there since.
    pub(crate) fn record_reply_of_unknown_age(&mut self, reply: &Reply) {
        let differs = |last: &Sample| last.reply.mode != reply.mode;
        self.other_loop = self.last.filter(differs).map(|_| reply.mode);
        self.count_reply();
    }

    /// Records that a reply arrived, without its content.
    pub(crate) fn count_reply(&mut self) {
        self.late.replied();
        self.left_in = None;
        if let Some(switched) = &mut self.switched_to {
            switched.outstanding = switched.outstanding.saturating_sub(1);
        }
    }

    /// The active setpoint, if the motor is driven.
    pub(crate) fn driven_mut(&mut self) -> Option<&mut Driven> {
        match &mut self.control {
            Control::Driven(driven) => Some(driven),
            _ => None,
        }
    }

    pub(crate) const fn is_driven(&self) -> bool {
        matches!(self.control, Control::Driven(_))
    }

    /// Whether its drive frames are withheld now.
    pub(crate) fn is_withheld(&self, now: Instant) -> bool {
        self.silence().is_some_and(|silence| now < silence.until())
    }

    /// The time without drive frames, if the motor is driven and has not got one since.
    pub(crate) const fn silence(&self) -> Option<Silence> {
        match &self.control {
            Control::Driven(driven) => driven.silence,
            _ => None,
        }
    }

    /// Whether a reply can still refine the angle of a hold.
    pub(crate) fn is_holding(&self, now: Instant) -> bool {
        match &self.control {
            Control::Driven(driven) => driven.hold.is_some_and(|hold| hold.is_open(now)),
            _ => false,
        }
    }

    /// The number of the group that it is driven in.
    pub(crate) const fn group(&self) -> Option<u32> {
        match &self.control {
            Control::Driven(driven) => driven.group,
            _ => None,
        }
    }

    /// Whether it was driven and no reply has reported standstill since.
    pub(crate) fn may_turn(&self) -> bool {
        self.rest != Rest::Known
    }

    /// Starts the stop of this motor and clears the exceeded limit.
    pub(crate) fn stops(&mut self, stop: Stopping) {
        self.control = Control::Stopping(stop);
        // A motor that never answered may not exist. If it was driven all the same, it still may turn.
        if self.has_answered() || self.may_turn() {
            self.rest = Rest::Unknown;
        }
        self.moved_raw = false;
        self.turning_unasked.clear();
        self.exceeded = None;
    }

    /// The limit that it has exceeded since driving began.
    pub(crate) fn exceeded(
        &self,
        now: Instant,
        limits: Limits,
        driven_since: Instant,
    ) -> Option<ExceededLimit> {
        if self.exceeded.is_some() {
            return self.exceeded;
        }
        let temperature = self.fresh_temperature(now);
        limits.exceeded(self.last?, temperature, self.overcurrent, driven_since)
    }
}
