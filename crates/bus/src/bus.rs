//! The bus itself: what goes in, what comes out, and the order in which it is handled.

use std::{collections::VecDeque, time::Duration};

use motorlink_protocol::{Frame, Instant, MotorId, Request};

use crate::{
    counters::Counters,
    event::{Event, StopReason},
    exchange::Line,
    job::state::{Proof, Survey},
    limits::Limits,
    line_use::LineUse,
    motor::{Activity, Control, Motor, MotorStatus},
    pending_transmit::HandedOut,
    probe::Ask,
    ramp::Ramp,
    rate::CommandRate,
    raw::frame::Raw,
    receiver::Receiver,
    round_trip::RoundTrip,
    schedule::{Errand, Pace, Turn, next_turn},
    stop::ActiveStop,
    timing::{CALL_FORGOTTEN, EARLY, JUST_FREED, LATE_CALL, SLEPT_AT_LEAST},
    watchdog::{Bark, Watchdog},
};

/// What [`Bus::poll`] wants done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// Write these ten bytes to the port, now; where the port does not take them, say so by [`Bus::unsent`].
    Transmit(Frame),
    /// Take note of this.
    Event(Event),
    /// Nothing before this moment, unless bytes or a command come: poll again then.
    Wait(Instant),
}

/// Where the last drive frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LastDrive {
    /// A byte has come since: the line carries what it is given.
    Carried,
    /// It was sent at this moment, and no byte has come since: the adapter may still have it.
    InFlight(Instant),
}

/// The one owner of the wire.
///
/// The caller keeps to one rule: after every input it polls until [`Output::Wait`], and polls again
/// at that moment at the latest.
#[derive(Debug)]
pub struct Bus {
    pub(crate) motors: Vec<Motor>,
    pub(crate) line: Line,
    pub(crate) receiver: Receiver,
    /// Round trips of all motors on this adapter.
    pub(crate) round_trip: RoundTrip,
    pub(crate) rate: CommandRate,
    pub(crate) ramp: Option<Ramp>,
    pub(crate) limits: Limits,
    /// The number of the last group that was driven together.
    pub(crate) last_group: u32,
    pub(crate) line_use: LineUse,
    /// Whether the last frame was a query.
    pub(crate) query_was_last: bool,
    pub(crate) last_drive: LastDrive,
    /// When a good frame came last outside its window.
    pub(crate) late_heard: Option<Instant>,
    /// Where several motors are driven, when the line may carry a query again.
    pub(crate) queries_from: Instant,
    /// When the last exchange ended.
    pub(crate) freed_at: Instant,
    /// Set by Stop all motors; nothing drives until it is released.
    pub(crate) halted: bool,
    pub(crate) stop: Option<ActiveStop>,
    pub(crate) id_query_wanted: bool,
    /// When the last ID query was sent whose window is spent.
    pub(crate) called: Option<Instant>,
    pub(crate) survey: Option<Survey>,
    /// The motor that a full scan has proved to be alone.
    pub(crate) proved_alone: Option<Proof>,
    pub(crate) raw: Option<Raw>,
    /// What happened on the line while no single motor was asked.
    pub(crate) counters: Counters,
    pub(crate) watchdog: Watchdog,
    /// The frame that was handed out last, until the next call says that it was taken.
    pub(crate) handed_out: Option<HandedOut>,
    /// Frames in a row that the port did not take.
    pub(crate) refused_in_a_row: u32,
    /// A question or a set-ID frame that the port did not take.
    pub(crate) survey_again: Option<Errand>,
    /// When the next call was asked for.
    pub(crate) call_due: Instant,
    /// During a stop: a motor that does not answer gets its next frame once all that answer have had this
    /// many.
    pub(crate) silent_stop_round: u32,
    /// First frames of a stop to motors that do not answer, since those that do got theirs.
    pub(crate) silent_firsts: u8,
    /// Drained by every poll, so it holds what one input can cause: a few a motor.
    pub(crate) events: VecDeque<Event>,
}

impl Bus {
    /// A bus on which nothing drives, whatever was before.
    #[must_use]
    pub fn new(now: Instant) -> Self {
        Self {
            motors: Vec::new(),
            line: Line::Free {
                last: Request::IdQuery.frame(),
            },
            receiver: Receiver::new(),
            round_trip: RoundTrip::new(),
            rate: CommandRate::default(),
            ramp: None,
            limits: Limits::default(),
            last_group: 0,
            line_use: LineUse::default(),
            query_was_last: false,
            last_drive: LastDrive::Carried,
            late_heard: None,
            queries_from: now,
            freed_at: now,
            halted: false,
            stop: None,
            id_query_wanted: false,
            called: None,
            survey: None,
            proved_alone: None,
            raw: None,
            counters: Counters::default(),
            watchdog: Watchdog::new(now),
            handed_out: None,
            refused_in_a_row: 0,
            survey_again: None,
            call_due: now,
            silent_stop_round: 0,
            silent_firsts: 0,
            events: VecDeque::new(),
        }
    }

    /// A bus that starts as Stop all motors left another: nothing drives until it is released.
    #[must_use]
    pub fn halted(now: Instant) -> Self {
        Self {
            halted: true,
            ..Self::new(now)
        }
    }

    /// Whether Stop all motors stands.
    #[must_use]
    pub const fn is_halted(&self) -> bool {
        self.halted
    }

    /// Whether a motor is driven, switched or being stopped, or turns by what we sent: the line must
    /// not be let go.
    #[must_use]
    pub fn is_active(&self, now: Instant) -> bool {
        let turns = |motor: &Motor| {
            let speed = motor.fresh_speed(now);
            motor.may_turn && speed.is_some_and(|speed| speed.magnitude() > 0)
        };
        let active = |motor: &Motor| !matches!(motor.control, Control::Idle) || turns(motor);
        self.motors.iter().any(active) || self.raw.is_some_and(|raw| raw.is_hazard_running())
    }

    /// Everything known of every motor.
    pub fn motors(&self, now: Instant) -> impl Iterator<Item = MotorStatus> {
        self.motors.iter().map(move |motor| {
            let mut status = motor.status(now);
            if self.is_driven_raw(motor.id) && status.activity == Activity::Idle {
                status.activity = Activity::DrivenRaw;
            }
            status
        })
    }

    /// The page has answered its ping.
    pub fn page_answered(&mut self, now: Instant) {
        self.begin_call(now);
        self.watchdog.answered(now);
    }

    /// What to do next. To be called until it answers [`Output::Wait`].
    pub fn poll(&mut self, now: Instant) -> Output {
        self.begin_call(now);
        match self.watchdog.wake(now) {
            Some(Bark::Ping) => self.events.push_back(Event::PingPage),
            Some(Bark::PageSilent) if self.is_active(now) => {
                self.stop_all(now, StopReason::PageSilent);
            }
            // Nobody would see how it ends.
            Some(Bark::PageSilent) => self.cancel_survey(now),
            None => {}
        }
        self.look_for_reply(now);
        self.end_spent_window(now);
        self.look_after_motors(now);
        let turn = match self.line {
            Line::Busy(exchange) => Turn::At(exchange.deadline()),
            Line::Free { .. } => self.next_turn(now),
        };
        let next_on_the_line = match turn {
            Turn::Now(errand) => return Output::Transmit(self.speak(now, errand)),
            Turn::At(at) => Some(at),
            Turn::Never => None,
        };
        if let Some(event) = self.events.pop_front() {
            return Output::Event(event);
        }
        let timers = self
            .motors
            .iter()
            .filter_map(|motor| Self::deadline(motor, now));
        let next = timers
            .chain(next_on_the_line)
            .fold(self.watchdog.deadline(), Instant::min);
        // Whatever is due was done above; a moment that is not in the future would be a busy loop.
        self.call_due = next.max(now + Duration::from_micros(1));
        Output::Wait(self.call_due)
    }

    /// What every call begins with: the last frame was taken, and the time is as it was expected.
    pub(crate) fn begin_call(&mut self, now: Instant) {
        self.settle_handed_out();
        let late = now.since(self.call_due);
        self.call_due = self.call_due.max(now);
        if late < LATE_CALL {
            return;
        }
        // What has waited meanwhile is no reading of now.
        self.end_spent_window(now);
        self.watchdog.resumed(now);
        let reason = if late < SLEPT_AT_LEAST {
            StopReason::LoopDelayed
        } else {
            StopReason::ComputerSlept
        };
        if self.is_active(now) {
            self.stop_all(now, reason);
        } else {
            // Nobody asked for the rest of it now.
            self.cancel_survey(now);
        }
    }

    fn next_turn(&mut self, now: Instant) -> Turn {
        if self.stop.is_none() {
            if let Some(errand) = self.survey_again.take()
                && self.survey.is_some()
            {
                return Turn::Now(errand);
            }
            if self.id_query_wanted {
                return Turn::Now(Errand::IdQuery);
            }
            if let Some(turn) = self.survey_turn(now) {
                return turn;
            }
            if let Some(at) = self.raw_has_line() {
                return self.raw_set_id_turn(now, at);
            }
        }
        // A stop has the line to itself but for what is driven beside it.
        let raw = self.raw.filter(|_| self.stop.is_none());
        let pace = Pace {
            usual: self.round_trip.usual(),
            period: self.rate.period(),
            query_was_last: self.query_was_last,
            just_freed: now.since(self.freed_at) < JUST_FREED,
            queries_from: self.queries_from,
            silent_stop_round: self.silent_stop_round,
            drive_waits_for_proof: matches!(self.last_drive, LastDrive::InFlight(_)),
        };
        next_turn(
            &self.motors,
            raw.and_then(|raw| raw.next_frame()),
            now,
            pace,
        )
    }

    /// Set-ID frames that a person wrote: the ID query first, then one behind the other.
    fn raw_set_id_turn(&self, now: Instant, at: Instant) -> Turn {
        if self.raw.is_some_and(|raw| raw.to_check.is_some()) {
            Turn::Now(Errand::Survey(Ask::Everyone))
        } else if now + EARLY >= at {
            Turn::Now(Errand::Raw)
        } else {
            Turn::At(at)
        }
    }

    /// Ends what is under way as the line is let go, and gives what is still to be told.
    pub fn close(&mut self, now: Instant) -> impl Iterator<Item = Event> {
        self.settle_handed_out();
        self.cancel_survey(now);
        self.events.drain(..)
    }

    pub(crate) fn motor_mut(&mut self, id: MotorId) -> Option<&mut Motor> {
        self.motors.iter_mut().find(|motor| motor.id == id)
    }

    /// The record of this motor, new if there was none. At most 254, one an address.
    pub(crate) fn watch(&mut self, now: Instant, id: MotorId) -> &mut Motor {
        let place = self
            .motors
            .iter()
            .position(|motor| motor.id == id)
            .unwrap_or_else(|| {
                let mut motor = Motor::new(now, id);
                let called = self.called.filter(|sent| now.since(*sent) < CALL_FORGOTTEN);
                if let Some(sent) = called {
                    motor.call_unanswered(sent);
                }
                self.motors.push(motor);
                self.motors.len() - 1
            });
        #[allow(
            clippy::indexing_slicing,
            reason = "the place was found or made just above"
        )]
        &mut self.motors[place]
    }
}
