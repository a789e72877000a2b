//! Sends frames and applies their effects once the port has taken them.

use std::cmp::Reverse;

use motorlink_protocol::{
    CurrentTarget, Frame, Instant, Mode, MotorId, Setpoint,
    family::{Layout, Request},
};

use crate::{
    bus::{Bus, LastDrive},
    driving::is_rest,
    exchange::{Exchange, Expects, Line, Purpose},
    line_event::LineEventKind,
    motor::Control,
    next_request::{SendContext, Sent, next_request},
    pending_transmit::{Effect, PendingTransmit},
    raw::status::RawAnswer,
    schedule::{DueFrame, LastFrame},
    timing::{REFUSED_MAX, REFUSED_PAUSE, SILENT_FIRSTS_MAX},
};

impl Bus {
    /// The frame that is due, for the caller to transmit.
    pub(crate) fn prepare_frame(&mut self, now: Instant, due_frame: DueFrame) -> Frame {
        self.process_unrequested_bytes(now);
        let due_frame = match due_frame {
            // A stalled adapter accepts frames and sends them later, behind a stop that the
            // operator has pressed meanwhile. So at most one drive frame is in flight. After it a
            // query, which moves no wheel however late it is sent, asks whether the line carries
            // frames.
            DueFrame::Drive(id) if self.waits_for_proof(now, id) => {
                DueFrame::Query(self.likely_to_answer(id))
            }
            DueFrame::Drive(id) if self.waits_for_loop(now, id) => DueFrame::LoopQuery(id),
            DueFrame::Raw => match self.raw_waits_for_loop(now) {
                Some(id) => DueFrame::LoopQuery(id),
                None => DueFrame::Raw,
            },
            due_frame => due_frame,
        };
        let model = self.model;
        let context = SendContext {
            model,
            period: self.settings.rate.period(),
            query_period: self.query_period(),
            ramp: self.settings.ramp,
            others_driven: self.any_driven(),
            slow_brake_frames: self.settings.slow_brake_frames,
        };
        let (frame, expects, purpose, effect) = match due_frame {
            DueFrame::Raw => {
                // A raw frame exists whenever one is due. The ID query is a harmless fallback.
                let frame = self
                    .raw
                    .map_or(self.frame_of(Request::IdQuery), |raw| raw.frame);
                let expects = Expects::of_raw(model, &frame);
                (frame, expects, Purpose::Raw, Effect::Raw)
            }
            DueFrame::IdQuery => {
                let request = Request::IdQuery;
                let expects = Expects::of(model, request);
                let frame = self.frame_of(request);
                (frame, expects, Purpose::Control, Effect::IdQuery)
            }
            DueFrame::Probe(_) | DueFrame::SetId(_) => {
                let request = match due_frame {
                    DueFrame::SetId(id) => Request::SetId { id },
                    DueFrame::Probe(ask) => ask.request(model),
                    _ => Request::IdQuery,
                };
                let effect = Effect::Job(due_frame);
                let expects = Expects::of(model, request);
                (self.frame_of(request), expects, Purpose::Job, effect)
            }
            DueFrame::Stop(id)
            | DueFrame::Switch(id)
            | DueFrame::Drive(id)
            | DueFrame::LoopQuery(id)
            | DueFrame::Query(id) => {
                let motor = self.watch(now, id);
                let (request, control, sent) = next_request(motor, now, due_frame, context);
                let effect = Effect::Motor { id, control, sent };
                let expects = Expects::of(model, request);
                (self.frame_of(request), expects, Purpose::Control, effect)
            }
        };
        let [addressee, ..] = *frame.bytes();
        let motor = self.motors.iter().find(|motor| motor.id.get() == addressee);
        let mode = motor.and_then(|motor| motor.reads_drive_frames_in(now));
        self.pending_transmit = Some(PendingTransmit {
            at: now,
            frame,
            expects,
            purpose,
            mode,
            effect,
        });
        frame
    }

    /// The bytes of a request. No request is made that the model does not have; the ID query is a harmless
    /// fallback.
    fn frame_of(&self, request: Request) -> Frame {
        let id_query = motorlink_protocol::Request::IdQuery;
        request
            .frame(self.model)
            .unwrap_or_else(|_| id_query.frame())
    }

    /// Whether the next drive frame to this motor waits until it has named its loop: it may have lost power, and
    /// would then read the value in the velocity loop.
    fn waits_for_loop(&self, now: Instant, id: MotorId) -> bool {
        let motor = self.motors.iter().find(|motor| motor.id == id);
        let setpoint = motor.and_then(|motor| match motor.control {
            Control::Driven(driven) if motor.must_name_loop(now) => Some(driven.goal),
            _ => None,
        });
        setpoint.is_some_and(|goal| goal.mode() != Mode::Velocity && !is_rest(goal))
    }

    /// The motor that is most likely to answer, or `otherwise`: not again the one that has just not answered, which may
    /// have lost power.
    fn likely_to_answer(&self, otherwise: MotorId) -> MotorId {
        let heard = self.motors.iter().filter(|motor| motor.has_answered());
        let last = heard.max_by_key(|motor| (Reverse(motor.lost_in_a_row), motor.silent_since()));
        last.map_or(otherwise, |motor| motor.id)
    }

    /// Whether the next drive frame to this motor waits until a received byte proves that the line
    /// carried the last one.
    fn waits_for_proof(&self, now: Instant, id: MotorId) -> bool {
        let LastDrive::InFlight(since) = self.last_drive else {
            return false;
        };
        let motor = self.motors.iter().find(|motor| motor.id == id);
        match motor.map(|motor| motor.control) {
            // After a refused frame every drive frame waits.
            _ if self.refused_in_a_row > 0 => true,
            Some(Control::Driven(driven)) if is_rest(driven.goal) => false,
            // Hold ends a motion: its first frame goes at once, each later one behind a query.
            Some(Control::Driven(driven)) => match driven.hold.filter(|hold| hold.is_open(now)) {
                Some(hold) => self.last_frame != LastFrame::Query && hold.began() <= since,
                None => true,
            },
            _ => false,
        }
    }

    /// Confirms the last frame: any call after it means that the port took it.
    pub(crate) fn commit_transmit(&mut self) {
        let Some(handed) = self.pending_transmit.take() else {
            return;
        };
        self.refused_in_a_row = 0;
        let PendingTransmit {
            at, frame, mode, ..
        } = handed;
        let kind = match (handed.effect, self.raw.is_some_and(|raw| raw.has_sent())) {
            (Effect::Raw, false) => LineEventKind::SentByHand { frame, mode },
            (Effect::Raw, true) => LineEventKind::RepeatedByHand { frame, mode },
            _ => LineEventKind::Sent { frame, mode },
        };
        self.log(at, kind);
        self.apply_effect(&handed);
        self.begin_exchange(&handed);
    }

    /// The port refused the last frame. Call it before anything else.
    ///
    /// The packet log records the frame as not sent, and the frame has no effect. The bus sends it
    /// again a little later. The frame counts as unanswered for its motor, so a port that takes
    /// nothing ends with withdrawn setpoints.
    pub fn transmit_failed(&mut self) {
        let Some(handed) = self.pending_transmit.take() else {
            return;
        };
        let PendingTransmit { at, frame, .. } = handed;
        self.log(at, LineEventKind::NotSent { frame });
        self.refused_in_a_row = self.refused_in_a_row.saturating_add(1);
        match handed.effect {
            // A raw frame is not sent at a time that the operator did not choose.
            Effect::Raw => {
                self.apply_effect(&handed);
                let raw = self.raw;
                self.count_refused(|id| raw.is_some_and(|raw| raw.may_move(id)));
                self.raw_answered(RawAnswer::NotSent);
            }
            Effect::Job(due_frame) if self.refused_in_a_row < REFUSED_MAX => {
                self.job_retry = Some(due_frame);
            }
            Effect::Job(DueFrame::SetId(_)) => self.cancel_job(at),
            // The port has refused frames for a second: it counts as a line without replies.
            Effect::Job(_) => {
                self.begin_exchange(&handed);
                return;
            }
            Effect::IdQuery => {}
            Effect::Motor { id, .. } => {
                self.count_refused(|motor| motor == id);
            }
        }
        self.line = Line::Busy(Exchange::pause(at, frame, at + REFUSED_PAUSE));
    }

    /// Counts a refused frame as unanswered for these motors.
    fn count_refused(&mut self, concerns: impl Fn(MotorId) -> bool) {
        for motor in self.motors.iter_mut().filter(|motor| concerns(motor.id)) {
            motor.unanswered_in_a_row = motor.unanswered_in_a_row.saturating_add(1);
        }
    }

    fn apply_effect(&mut self, handed: &PendingTransmit) {
        let now = handed.at;
        let sent = match handed.effect {
            Effect::Motor { sent, .. } => Some(sent),
            _ => None,
        };
        self.last_frame = match (sent, self.last_frame) {
            (Some(Sent::Stop), _) => LastFrame::Stop,
            // A mode switch does not release a frame that waits for a query.
            (Some(Sent::Query(_)), _) | (Some(Sent::Switch { .. }), LastFrame::Query) => {
                LastFrame::Query
            }
            _ => LastFrame::Other,
        };
        match handed.effect {
            Effect::IdQuery => self.id_query_wanted = false,
            Effect::Job(_) => {}
            Effect::Raw => self.raw_goes_out(now),
            Effect::Motor { id, control, sent } => {
                let is_query = matches!(sent, Sent::Query(_));
                let mut stops_silent = None;
                let mut drives = false;
                let period = self.settings.rate.period();
                let motor = self.watch(now, id);
                let before = motor.control;
                let is_first =
                    matches!(motor.control, Control::Stopping(stop) if stop.last_sent().is_none());
                motor.control = control;
                match sent {
                    Sent::Stop => {
                        stops_silent = motor.is_without_answer().then_some(is_first);
                    }
                    Sent::Switch { to, is_last } => {
                        if is_last {
                            // Ask whether the motor has switched.
                            motor.next_query = now;
                        }
                        motor.switch_sent(now, to);
                    }
                    Sent::Drive(setpoint) => {
                        drives = setpoint.is_some_and(|setpoint| !is_rest(setpoint));
                        motor.drive_sent(now, before, period);
                        match setpoint {
                            Some(Setpoint::Current(current)) => motor.torque.sent(current),
                            Some(Setpoint::OpenLoop(target)) => {
                                let torque = CurrentTarget::new(target.raw().into());
                                motor.torque.sent(torque.unwrap_or_default());
                            }
                            _ => {}
                        }
                    }
                    Sent::Query(context) | Sent::LoopQuery(context) => {
                        motor.query_sent(now, context.query_period, context.others_driven);
                    }
                }
                if drives {
                    self.last_drive = LastDrive::InFlight(now);
                }
                if let Some(is_first) = stops_silent {
                    self.silent_firsts = if is_first { self.silent_firsts + 1 } else { 0 };
                    if !is_first || self.silent_firsts >= SILENT_FIRSTS_MAX {
                        self.silent_firsts = 0;
                        self.silent_stopped = Some(now);
                    }
                }
                if is_query {
                    self.queries_from = now + self.query_distance();
                }
            }
        }
    }

    fn begin_exchange(&mut self, handed: &PendingTransmit) {
        let &PendingTransmit {
            at,
            frame,
            expects,
            purpose,
            ..
        } = handed;
        let window = self.reply_window(at, expects, purpose);
        let airtime = self.model.frame_airtime();
        let exchange = Exchange::begin(at, frame, expects, window, airtime, purpose);
        match expects {
            Expects::Reply { id, layout } => match self.motor_mut(id) {
                Some(motor) => {
                    motor.counters.requests += 1;
                    if layout != Layout::Query {
                        motor.late.asked_otherwise(at);
                    }
                }
                None => self.counters.requests += 1,
            },
            Expects::Everyone { .. } => {
                self.counters.requests += 1;
                for motor in &mut self.motors {
                    motor.late.asked_otherwise(at);
                }
            }
            Expects::Nothing => {}
        }
        self.line = Line::Busy(exchange);
    }
}
