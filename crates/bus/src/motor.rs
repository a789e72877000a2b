//! What the bus knows of one motor and does with it.

use std::time::Duration;

use motorlink_protocol::{
    Celsius, Detail, Faults, Instant, Layout, Mode, MotorId, Position, Reply, Rpm, Setpoint,
};

use crate::{
    Counters, LinkQuality, Sample,
    counters::LossMeter,
    mode_switch::Switch,
    rate::RateMeter,
    round_trip::RoundTrip,
    stop::Stopping,
    timing::{FRESH_FOR, LATE_REPLY_MAX, QUERY_PERIOD, SILENT_AFTER},
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
    /// The setpoint of the last frame.
    pub(crate) on_the_wire: Option<Setpoint>,
    pub(crate) since: Instant,
    pub(crate) next_frame: Instant,
}

impl Driven {
    pub(crate) const fn begin(now: Instant, goal: Setpoint) -> Self {
        Self {
            goal,
            on_the_wire: None,
            since: now,
            next_frame: now,
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
    watched_since: Instant,
    pub(crate) silent: bool,
    /// The last request that was not answered: its reply may still come.
    unanswered: Option<(Layout, Instant)>,
    pub(crate) next_query: Instant,
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
            watched_since: now,
            silent: false,
            unanswered: None,
            next_query: now,
            counters: Counters::default(),
            round_trip: RoundTrip::new(),
            loss: LossMeter::default(),
            drive_frames: RateMeter::default(),
        }
    }

    /// Keeps what a reply says. Returns whether the motor had been silent.
    pub(crate) fn heard(&mut self, at: Instant, reply: Reply) -> bool {
        self.last = Some(Sample { at, reply });
        match reply.detail {
            Detail::Drive { position } => self.position = Some((at, position)),
            Detail::Query { temperature, .. } => self.temperature = Some((at, temperature)),
            Detail::Undetermined(_) => {}
        }
        std::mem::take(&mut self.silent)
    }

    /// The layout in which a reply to a request in `layout` can be read now: none while a late
    /// reply in the other one may still come.
    pub(crate) fn layout_of_reply(&self, now: Instant, layout: Layout) -> Option<Layout> {
        let other_pending = self
            .pending_layout(now)
            .is_some_and(|pending| pending != layout);
        (!other_pending).then_some(layout)
    }

    /// The layout of a request whose window is spent but whose reply may still come.
    pub(crate) fn pending_layout(&self, now: Instant) -> Option<Layout> {
        let (layout, sent) = self.unanswered?;
        (now < sent + LATE_REPLY_MAX).then_some(layout)
    }

    /// Until when a query would mix up layouts with a drive reply that may come late.
    pub(crate) fn drive_reply_pending_until(&self) -> Option<Instant> {
        match self.unanswered {
            Some((Layout::Drive, sent)) => Some(sent + LATE_REPLY_MAX),
            _ => None,
        }
    }

    pub(crate) fn lost(&mut self, layout: Layout, sent: Instant) {
        self.unanswered = Some((layout, sent));
    }

    fn fresh(&self, now: Instant) -> Option<Reply> {
        self.last
            .filter(|sample| now.since(sample.at) <= FRESH_FOR)
            .map(|sample| sample.reply)
    }

    pub(crate) fn fresh_mode(&self, now: Instant) -> Option<Mode> {
        self.fresh(now).map(|reply| reply.mode)
    }

    pub(crate) fn fresh_speed(&self, now: Instant) -> Option<Rpm> {
        self.fresh(now).map(|reply| reply.speed)
    }

    pub(crate) fn fresh_faults(&self, now: Instant) -> Option<Faults> {
        self.fresh(now).map(|reply| reply.faults)
    }

    pub(crate) fn fresh_position(&self, now: Instant) -> Option<Position> {
        self.position
            .filter(|(at, _)| now.since(*at) <= FRESH_FOR)
            .map(|(_, position)| position)
    }

    pub(crate) fn last_mode(&self) -> Option<Mode> {
        self.last.map(|sample| sample.reply.mode)
    }

    pub(crate) const fn ever_heard(&self) -> bool {
        self.last.is_some()
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

    pub(crate) fn query_sent(&mut self, now: Instant) {
        // On schedule where it is kept, without a burst where it was not.
        self.next_query = (self.next_query + QUERY_PERIOD).max(now + QUERY_PERIOD / 2);
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
