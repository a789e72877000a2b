//! The bus: its state, its inputs and outputs, and the order in which it handles them.

use std::{collections::VecDeque, time::Duration};

use motorlink_protocol::{Frame, Instant, MotorId, Request, family::Model};

use crate::{
    counters::Counters,
    event::{Event, StopReason},
    exchange::Line,
    job::state::{Job, Proof},
    junk_logged::JunkLogged,
    late_window::LateWindow,
    line_event::{LineEvent, LineEventKind},
    line_use::LineUse,
    model::{evidence::ModelEvidence, foreign_text::ForeignText},
    motor::Motor,
    pending_transmit::PendingTransmit,
    probe::Probe,
    rate::RateMeter,
    raw::frame::Raw,
    receiver::Receiver,
    round_trip::RoundTrip,
    schedule::{DueFrame, LastFrame, Pacing, Turn, next_turn},
    settings::BusSettings,
    stop::ActiveStop,
    timing::{
        EARLY, ID_QUERY_FORGOTTEN, JUST_FREED, LATE, LATE_CALL, LISTEN_BEFORE_ENABLE, SLEEP_MIN,
    },
    watchdog::{Watchdog, WatchdogAction},
};

/// What the caller does next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// Write these ten bytes to the port now. If the port does not take them, call
    /// [`Bus::transmit_failed`].
    Transmit(Frame),
    /// Something happened.
    Event(Event),
    /// Poll again at this moment, or earlier when bytes or a command arrive.
    Wait(Instant),
}

/// Whether the line has carried the last drive frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LastDrive {
    /// A byte arrived after it: the line carries frames.
    Carried,
    /// Sent at this moment, and no byte has arrived since: the adapter may still hold it.
    InFlight(Instant),
}

/// The only owner of the wire.
///
/// The caller follows one rule: after every input it polls until [`Output::Wait`], and polls again
/// at that moment at the latest.
#[derive(Debug)]
pub struct Bus {
    /// The model of all motors on the line.
    pub(crate) model: Model,
    /// What replies have told about the model.
    pub(crate) evidence: ModelEvidence,
    /// Text of another device than a motor.
    pub(crate) text: ForeignText,
    /// How much junk the packet log has taken.
    pub(crate) junk_logged: JunkLogged,
    /// Earliest time at which the bus may enable a motor without a command; `None` while the port is on trial.
    pub(crate) enables_from: Option<Instant>,
    pub(crate) motors: Vec<Motor>,
    pub(crate) line: Line,
    pub(crate) receiver: Receiver,
    /// Round trips of all motors on this adapter.
    pub(crate) round_trip: RoundTrip,
    pub(crate) settings: BusSettings,
    /// Number of the last group that was driven.
    pub(crate) last_group: u32,
    pub(crate) line_use: LineUse,
    /// Calls and replies that came late.
    pub(crate) late: RateMeter,
    pub(crate) last_frame: LastFrame,
    pub(crate) last_drive: LastDrive,
    /// Until then another late reply is expected.
    pub(crate) late_until: Instant,
    /// Set by late replies that are certain.
    pub(crate) late_window: LateWindow,
    /// Earliest time of the next query while several motors are driven.
    pub(crate) queries_from: Instant,
    /// When the last exchange ended.
    pub(crate) freed_at: Instant,
    /// Set by Stop all motors. Nothing drives until Release.
    pub(crate) halted: bool,
    pub(crate) stop: Option<ActiveStop>,
    pub(crate) id_query_wanted: bool,
    /// When the last ID query was sent whose window has ended.
    pub(crate) last_id_query: Option<Instant>,
    pub(crate) job: Option<Job>,
    /// The only motor on the bus, proved by a full scan.
    pub(crate) proved_alone: Option<Proof>,
    pub(crate) raw: Option<Raw>,
    /// Counters of exchanges with no single motor as addressee.
    pub(crate) counters: Counters,
    pub(crate) watchdog: Watchdog,
    /// The last frame given to the caller, until the next call confirms that the port took it.
    pub(crate) pending_transmit: Option<PendingTransmit>,
    /// Frames in a row that the port refused.
    pub(crate) refused_in_a_row: u32,
    /// The frame of a scan or ID change that the port refused, to be sent again.
    pub(crate) job_retry: Option<DueFrame>,
    /// When the bus asked for the next call.
    pub(crate) call_due: Instant,
    /// Until when a new motor may still answer a request from before this bus.
    pub(crate) old_replies_until: Option<Instant>,
    /// During a stop, a silent motor gets its next frame after every answering motor has got one since then.
    pub(crate) silent_stopped: Option<Instant>,
    /// First stop frames to silent motors since the last frame to an answering one.
    pub(crate) silent_firsts: u8,
    /// Every poll drains it, so its length is bounded by the events of one input: a few per motor.
    pub(crate) events: VecDeque<Event>,
}

impl Bus {
    /// A bus that drives nothing, for DDSM115 motors.
    #[must_use]
    pub fn new(now: Instant) -> Self {
        Self::with_model(now, Model::Ddsm115)
    }

    /// A bus that drives nothing, for motors of this model on a line of its baud rate.
    #[must_use]
    pub fn with_model(now: Instant, model: Model) -> Self {
        let kind = LineEventKind::ModelSelected(model);
        Self {
            model,
            evidence: ModelEvidence::default(),
            text: ForeignText::default(),
            junk_logged: JunkLogged::default(),
            enables_from: Some(now + LISTEN_BEFORE_ENABLE),
            motors: Vec::new(),
            line: Line::Free {
                last: Request::IdQuery.frame(),
            },
            receiver: Receiver::new(model),
            round_trip: RoundTrip::new(),
            settings: BusSettings::default(),
            last_group: 0,
            line_use: LineUse::default(),
            late: RateMeter::default(),
            last_frame: LastFrame::Other,
            last_drive: LastDrive::Carried,
            late_until: Instant::ZERO,
            late_window: LateWindow::default(),
            queries_from: now,
            old_replies_until: None,
            freed_at: now,
            halted: false,
            stop: None,
            id_query_wanted: false,
            last_id_query: None,
            job: None,
            proved_alone: None,
            raw: None,
            counters: Counters::default(),
            watchdog: Watchdog::new(now),
            pending_transmit: None,
            refused_in_a_row: 0,
            job_retry: None,
            call_due: now,
            silent_stopped: None,
            silent_firsts: 0,
            events: VecDeque::from([Event::Line(LineEvent { at: now, kind })]),
        }
    }

    /// The page has answered its ping.
    pub fn page_answered(&mut self, now: Instant) {
        self.begin_call(now);
        self.watchdog.answered(now);
    }

    /// The next step. Call it until it returns [`Output::Wait`].
    pub fn poll(&mut self, now: Instant) -> Output {
        self.begin_call(now);
        match self.watchdog.poll(now) {
            Some(WatchdogAction::Ping) => self.events.push_back(Event::PingPage),
            Some(WatchdogAction::Expired) if self.is_active(now) => {
                self.stop_all(now, StopReason::PageSilent);
            }
            // No page is left to show the result.
            Some(WatchdogAction::Expired) => self.cancel_job(now),
            None => {}
        }
        self.look_for_reply(now);
        self.end_spent_window(now);
        self.stop_what_is_back(now);
        self.supervise_motors(now);
        let turn = match self.line {
            Line::Busy(exchange) => Turn::At(exchange.deadline()),
            Line::Free { .. } => self.next_turn(now),
        };
        let next_on_the_line = match turn {
            Turn::Now(due_frame) => return Output::Transmit(self.prepare_frame(now, due_frame)),
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
        // Everything due is done. A time that is not in the future would make a busy loop.
        self.call_due = next.max(now + Duration::from_micros(1));
        Output::Wait(self.call_due)
    }

    /// Start of every call: confirms the last frame and checks the time since the last call.
    pub(crate) fn begin_call(&mut self, now: Instant) {
        self.commit_transmit();
        let late = now.since(self.call_due);
        self.call_due = self.call_due.max(now);
        if late > LATE {
            self.late.count(now);
            for motor in &mut self.motors {
                motor.called_late(late);
            }
        }
        if late < LATE_CALL {
            return;
        }
        // Bytes that waited during the gap are not current.
        self.end_spent_window(now);
        self.watchdog.resumed(now);
        let reason = if late < SLEEP_MIN {
            StopReason::LoopDelayed
        } else {
            StopReason::ComputerSlept
        };
        if self.is_active(now) {
            self.stop_all(now, reason);
        } else {
            // The operator asked for it before the gap.
            self.cancel_job(now);
        }
    }

    fn next_turn(&mut self, now: Instant) -> Turn {
        if self.stop.is_none() {
            if let Some(due_frame) = self.job_retry.take()
                && self.job.is_some()
            {
                return Turn::Now(due_frame);
            }
            if self.id_query_wanted {
                return Turn::Now(DueFrame::IdQuery);
            }
            if let Some(turn) = self.next_job_turn(now) {
                return turn;
            }
            if let Some(at) = self.raw_has_line() {
                return self.raw_set_id_turn(now, at);
            }
        }
        // During a stop only driven motors share the line with it.
        let raw = self.raw.filter(|_| self.stop.is_none());
        let pacing = Pacing {
            usual: self.round_trip.usual(),
            period: self.settings.rate.period(),
            last_frame: self.last_frame,
            just_freed: now.since(self.freed_at) < JUST_FREED,
            queries_from: self.queries_from,
            silent_stopped: self.silent_stopped,
            stops_first: self.stops_first(),
            drive_waits_for_proof: matches!(self.last_drive, LastDrive::InFlight(_)),
        };
        next_turn(
            &self.motors,
            raw.and_then(|raw| raw.next_frame()),
            now,
            pacing,
        )
    }

    /// Raw set-ID frames: the ID query first, then all frames in a row.
    fn raw_set_id_turn(&self, now: Instant, at: Instant) -> Turn {
        if self.raw.is_some_and(|raw| raw.to_check.is_some()) {
            Turn::Now(DueFrame::Probe(Probe::IdQuery))
        } else if now + EARLY >= at {
            Turn::Now(DueFrame::Raw)
        } else {
            Turn::At(at)
        }
    }

    /// Ends the current job before the port closes and returns the events that are left.
    pub fn close(&mut self, now: Instant) -> impl Iterator<Item = Event> {
        self.commit_transmit();
        self.cancel_job(now);
        self.events.drain(..)
    }

    pub(crate) fn motor_mut(&mut self, id: MotorId) -> Option<&mut Motor> {
        self.motors.iter_mut().find(|motor| motor.id == id)
    }

    /// The state of this motor, created if it is new. At most 254 motors, one per address.
    pub(crate) fn watch(&mut self, now: Instant, id: MotorId) -> &mut Motor {
        let model = self.model;
        let place = self
            .motors
            .iter()
            .position(|motor| motor.id == id)
            .unwrap_or_else(|| {
                let mut motor = Motor::new(now, model, id);
                let last_id_query = self
                    .last_id_query
                    .filter(|sent| now.since(*sent) < ID_QUERY_FORGOTTEN);
                if let Some(sent) = last_id_query {
                    motor.id_query_unanswered(sent);
                } else if self.old_replies_until.is_some_and(|until| now < until) {
                    motor.unknown_frame_unanswered(now);
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
