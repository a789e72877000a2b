//! What the bus knows of one motor and does with it.

use std::time::Duration;

use motorlink_protocol::{
    Celsius, Detail, Faults, Instant, Layout, Mode, MotorId, Position, Reply, Rpm, Setpoint,
};

use crate::{
    angle_estimate::{Hold, Reckoning},
    angle_filter::Angles,
    counters::{Counters, LinkQuality, LossMeter},
    late_replies::LateReplies,
    limits::{Crossed, Limits, Overcurrent},
    mode_switch::Switch,
    ramp::Ramped,
    rate::RateMeter,
    round_trip::RoundTrip,
    safety::Known,
    sample::Sample,
    stop::Stopping,
    temperature_filter::Temperatures,
    timing::{
        DRIVEN_UNANSWERED_MAX, FRESH_FOR, PROBE_DOUBLINGS_MAX, SILENT_AFTER, SILENT_QUERY_PERIOD,
    },
    torque::Torque,
};

/// What the bus does with a motor.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Control {
    /// Asks for telemetry and nothing else.
    Idle,
    Switching(Switch),
    Driven(Driven),
    Stopping(Stopping),
}

/// An operator's command that stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Driven {
    pub(crate) goal: Setpoint,
    /// Since when it is driven; its silence counts from here at the earliest.
    pub(crate) since: Instant,
    pub(crate) next_frame: Instant,
    /// When the next frame would be due had every one gone out in time.
    pub(crate) on_schedule: Instant,
    /// Since Hold, until a reply within 40 ms has said where the wheel was then.
    pub(crate) hold: Option<Hold>,
    /// The number of the group that it is driven in; none goes on without the others.
    pub(crate) group: Option<u32>,
    /// The speed that was sent last.
    pub(crate) ramped: Ramped,
}

impl Driven {
    /// Driven from now on, from the speed that the wheel has.
    pub(crate) fn begin(now: Instant, goal: Setpoint, speed: Option<Rpm>) -> Self {
        Self {
            goal,
            since: now,
            next_frame: now,
            on_schedule: now,
            hold: None,
            group: None,
            ramped: Ramped::from(now, speed),
        }
    }
}

/// What the bus does with a motor, as the page shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Activity {
    /// It is only listened to; the wheel is free.
    Idle,
    /// Its loop is being changed.
    Switching {
        /// To this one.
        to: Mode,
    },
    /// It is driven.
    Driven {
        /// To this setpoint.
        setpoint: Setpoint,
    },
    /// A frame that a person wrote is sent to it again and again.
    DrivenRaw,
    /// It is being braked to a standstill.
    Stopping {
        /// Whether its replies have reported standstill.
        confirmed: bool,
    },
}

/// Everything that the page shows of one motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotorStatus {
    /// Which motor.
    pub id: MotorId,
    /// What is done with it.
    pub activity: Activity,
    /// Its last reply.
    pub last: Option<Sample>,
    /// Its last fine position, from a drive reply.
    pub position: Option<(Instant, Position)>,
    /// Its last temperature, from a feedback query.
    pub temperature: Option<(Instant, Celsius)>,
    /// Whether it has not answered for two seconds.
    pub silent: bool,
    /// How well the line to it works.
    pub link: LinkQuality,
    /// What happened on the line to it.
    pub counters: Counters,
}

#[derive(Clone, Debug)]
pub(crate) struct Motor {
    pub(crate) id: MotorId,
    pub(crate) control: Control,
    /// Whether it was driven and has not been seen standing since.
    pub(crate) may_turn: bool,
    last: Option<Sample>,
    position: Option<(Instant, Position)>,
    temperature: Option<(Instant, Celsius)>,
    overcurrent: Overcurrent,
    /// The limit that a reply has crossed since it is driven, whatever later ones said.
    crossed: Option<Crossed>,
    watched_since: Instant,
    pub(crate) silent: bool,
    pub(crate) late: LateReplies,
    temperatures: Temperatures,
    angles: Angles,
    pub(crate) reckoning: Reckoning,
    pub(crate) torque: Torque,
    /// Requests since the last reply.
    pub(crate) unanswered_in_a_row: u32,
    /// The loop that was asked for since the motor last said which it is in.
    switched_to: Option<Mode>,
    pub(crate) next_query: Instant,
    /// Queries since it fell silent while others were driven.
    probes: u32,
    pub(crate) counters: Counters,
    pub(crate) round_trip: RoundTrip,
    pub(crate) loss: LossMeter,
    pub(crate) drive_frames: RateMeter,
}

impl Motor {
    pub(crate) fn new(now: Instant, id: MotorId) -> Self {
        Self {
            id,
            control: Control::Idle,
            may_turn: false,
            last: None,
            position: None,
            temperature: None,
            overcurrent: Overcurrent::default(),
            crossed: None,
            watched_since: now,
            silent: false,
            late: LateReplies::default(),
            temperatures: Temperatures::default(),
            angles: Angles::default(),
            reckoning: Reckoning::default(),
            torque: Torque::default(),
            unanswered_in_a_row: 0,
            switched_to: None,
            next_query: now,
            probes: 0,
            counters: Counters::default(),
            round_trip: RoundTrip::new(),
            loss: LossMeter::default(),
            drive_frames: RateMeter::default(),
        }
    }

    /// Keeps what a reply says. Returns whether the motor had been silent.
    pub(crate) fn heard(&mut self, at: Instant, reply: Reply, limits: Limits) -> bool {
        let sample = Sample { at, reply };
        self.last = Some(sample);
        self.overcurrent.heard(sample, limits);
        if let Control::Driven(driven) = self.control {
            let crossed = limits.crossed(sample, None, self.overcurrent, driven.since);
            self.crossed = self.crossed.or(crossed);
        }
        self.unanswered_in_a_row = 0;
        self.late.replied();
        match reply.detail {
            Detail::Drive { position } => self.position = Some((at, position)),
            Detail::Query { temperature, .. } => self.temperature = Some((at, temperature)),
            Detail::Undetermined(_) => {}
        }
        std::mem::take(&mut self.silent)
    }

    /// In which layout its reply to a request in `layout` can be read now.
    pub(crate) fn layout_of(
        &mut self,
        now: Instant,
        reply: Reply,
        layout: Layout,
    ) -> Option<Layout> {
        let layout = self.late.layout_of_reply(now, layout)?;
        let reply = reply.in_layout(Some(layout));
        let certain = self.late.none_was_ever_owed();
        let (degrees, fits) = match reply.detail {
            Detail::Query {
                temperature,
                position,
            } => {
                let fits = self.temperatures.follows(now, temperature, certain);
                (position.degrees(), fits)
            }
            Detail::Drive { position } => (position.degrees(), true),
            Detail::Undetermined(_) => return Some(layout),
        };
        // Each of them sees every reading.
        let follows = self.angles.follows(now, degrees, reply.speed, certain);
        (fits && follows).then_some(layout)
    }

    /// What it is driven to.
    pub(crate) fn driven_mut(&mut self) -> Option<&mut Driven> {
        match &mut self.control {
            Control::Driven(driven) => Some(driven),
            _ => None,
        }
    }

    /// Whether a reply can still say where the wheel was at Hold.
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

    pub(crate) fn lost(&mut self, layout: Layout, sent: Instant) {
        self.unanswered_in_a_row = self.unanswered_in_a_row.saturating_add(1);
        self.late.unanswered(layout, sent, self.unanswered_in_a_row);
    }

    /// An ID query was sent to all, and its answer, in the layout of a drive reply, was not heard.
    pub(crate) fn call_unanswered(&mut self, sent: Instant) {
        self.late.unanswered(Layout::Drive, sent, 1);
    }

    /// A mode switch was sent. Where two were, the position loop, in which zero moves the wheel, is
    /// the one to reckon with.
    pub(crate) fn switch_sent(&mut self, to: Mode) {
        if self.switched_to != Some(Mode::Position) {
            self.switched_to = Some(to);
        }
    }

    /// The motor has said which loop it is in, after the last mode switch that was sent.
    pub(crate) fn loop_reported(&mut self) {
        self.switched_to = None;
    }

    /// Whether a mode switch was sent since the motor last said which loop it is in.
    pub(crate) const fn loop_is_in_the_air(&self) -> bool {
        self.switched_to.is_some()
    }

    /// The loop by a reply of the last 500 ms, and by older knowledge.
    pub(crate) fn known_loop(&self, now: Instant) -> (Option<Mode>, Option<Mode>) {
        let last = self.last_mode();
        match self.switched_to {
            Some(Mode::Position) => (None, Some(Mode::Position)),
            Some(_) => (None, last),
            None => (self.fresh_mode(now), last),
        }
    }

    /// The loop in which the value of a drive frame that is sent now is meant, for the log.
    pub(crate) fn reads_drive_frames_in(&self, now: Instant) -> Option<Mode> {
        match self.control {
            Control::Driven(driven) => Some(driven.goal.mode()),
            // A stop brakes, which only the velocity loop knows.
            Control::Stopping(_) => Some(Mode::Velocity),
            Control::Idle | Control::Switching(_) => self.fresh_mode(now),
        }
    }

    fn fresh(&self, now: Instant) -> Option<Reply> {
        self.last
            .filter(|sample| now.since(sample.at) <= FRESH_FOR)
            .map(|sample| sample.reply)
    }

    pub(crate) fn fresh_mode(&self, now: Instant) -> Option<Mode> {
        self.fresh(now)
            .filter(|_| self.switched_to.is_none())
            .map(|reply| reply.mode)
    }

    pub(crate) fn fresh_speed(&self, now: Instant) -> Option<Rpm> {
        self.fresh(now).map(|reply| reply.speed)
    }

    pub(crate) fn fresh_faults(&self, now: Instant) -> Option<Faults> {
        self.fresh(now).map(|reply| reply.faults)
    }

    fn fresh_temperature(&self, now: Instant) -> Option<Celsius> {
        let (_, temperature) = self
            .temperature
            .filter(|(at, _)| now.since(*at) <= FRESH_FOR)?;
        Some(temperature)
    }

    pub(crate) fn known(&self, now: Instant) -> Known {
        Known {
            reported: self.fresh_mode(now),
            faults: self.fresh_faults(now),
            temperature: self.fresh_temperature(now),
        }
    }

    /// It is stopped: what it crossed is done with.
    pub(crate) fn stops(&mut self, stop: Stopping) {
        self.control = Control::Stopping(stop);
        self.may_turn = true;
        self.crossed = None;
    }

    /// The limit that it has crossed since it is driven.
    pub(crate) fn crossed(
        &self,
        now: Instant,
        limits: Limits,
        driven_since: Instant,
    ) -> Option<Crossed> {
        if self.crossed.is_some() {
            return self.crossed;
        }
        let temperature = self.fresh_temperature(now);
        limits.crossed(self.last?, temperature, self.overcurrent, driven_since)
    }

    pub(crate) fn last_mode(&self) -> Option<Mode> {
        self.last.map(|sample| sample.reply.mode)
    }

    pub(crate) const fn ever_heard(&self) -> bool {
        self.last.is_some()
    }

    /// Whether its last requests had no answer, one like the other.
    pub(crate) const fn is_without_answer(&self) -> bool {
        self.unanswered_in_a_row >= DRIVEN_UNANSWERED_MAX
    }

    /// Since when the motor has said nothing.
    pub(crate) fn quiet_since(&self) -> Instant {
        self.last.map_or(self.watched_since, |sample| {
            sample.at.max(self.watched_since)
        })
    }

    pub(crate) fn silent_at(&self) -> Instant {
        self.quiet_since() + SILENT_AFTER
    }

    /// How long a driven motor has been silent, counted from the command at the earliest.
    pub(crate) fn quiet_while_driven(&self, now: Instant, driven: &Driven) -> Duration {
        now.since(self.quiet_since().max(driven.since))
    }

    /// It was asked. `period` is how often a motor that answers is asked; `in_the_way` is whether
    /// others are driven meanwhile.
    pub(crate) fn query_sent(&mut self, now: Instant, period: Duration, in_the_way: bool) {
        // A silent motor costs the others a window each time: it is asked ever more rarely.
        let period = if !self.silent {
            self.probes = 0;
            period
        } else if in_the_way {
            self.probes = (self.probes + 1).min(PROBE_DOUBLINGS_MAX);
            SILENT_QUERY_PERIOD * (1 << self.probes)
        } else {
            self.probes = 0;
            SILENT_QUERY_PERIOD
        };
        // On schedule where it is kept, without a burst where it was not.
        self.next_query = (self.next_query + period).max(now + period / 2);
    }

    pub(crate) fn status(&self, now: Instant) -> MotorStatus {
        MotorStatus {
            id: self.id,
            activity: match self.control {
                Control::Idle => Activity::Idle,
                Control::Switching(switch) => Activity::Switching { to: switch.to },
                Control::Driven(driven) => Activity::Driven {
                    setpoint: driven.goal,
                },
                Control::Stopping(stop) => Activity::Stopping {
                    confirmed: stop.confirmed(),
                },
            },
            last: self.last,
            position: self.position,
            temperature: self.temperature,
            silent: self.silent,
            link: LinkQuality {
                command_hz: self.drive_frames.hertz(now),
                round_trip_us: self.round_trip.median_us(),
                loss_per_mille: self.loss.per_mille(),
            },
            counters: self.counters,
        }
    }
}
