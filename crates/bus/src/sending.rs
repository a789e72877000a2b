//! What is sent, and what is known of it once the port has taken it.

use std::time::Duration;

use motorlink_protocol::{Frame, Instant, Layout, MotorId, Request, Setpoint};

use crate::{
    bus::{Bus, LastDrive},
    driving::rests,
    exchange::{Exchange, Expects, Line, Purpose},
    motor::Control,
    next_request::{Sent, Tempo, next_request},
    pending_transmit::{Effect, HandedOut},
    raw::status::RawAnswer,
    schedule::Errand,
    timing::{
        FIRST_WINDOW, ID_QUERY_WINDOW, LATE_FORGOTTEN, MAX_WINDOW, REFUSED_MAX, REFUSED_PAUSE,
        SILENT_FIRSTS_MAX,
    },
    traffic::Passed,
};

impl Bus {
    /// Hands out the frame of an errand.
    pub(crate) fn speak(&mut self, now: Instant, errand: Errand) -> Frame {
        self.sort_unasked_bytes(now);
        let errand = match errand {
            // An adapter that stalls takes frames and carries none, and each comes out of it later, behind
            // a stop that was pressed meanwhile. So one drive frame may be in flight, and behind it a query
            // asks whether the line carries anything: it moves no wheel, however late it comes.
            Errand::Drive(id) if self.waits_for_proof(now, id) => {
                Errand::Query(self.last_to_answer(id))
            }
            errand => errand,
        };
        let tempo = Tempo {
            period: self.rate.period(),
            query_period: self.query_period(),
            ramp: self.ramp,
            others_driven: self.anyone_driven(),
        };
        let (frame, expects, purpose, effect) = match errand {
            Errand::Raw => {
                // Without a frame nothing would be due; the ID query harms nobody.
                let frame = self.raw.map_or(Request::IdQuery.frame(), |raw| raw.frame);
                let expects = Expects::of_raw(&frame);
                (frame, expects, Purpose::Raw, Effect::Raw)
            }
            Errand::IdQuery => {
                let request = Request::IdQuery;
                let expects = Expects::of(&request);
                (request.frame(), expects, Purpose::Control, Effect::IdQuery)
            }
            Errand::Survey(_) | Errand::SetId(_) => {
                let request = match errand {
                    Errand::SetId(id) => Request::SetId { id },
                    Errand::Survey(ask) => ask.request(),
                    _ => Request::IdQuery,
                };
                let effect = Effect::Survey(errand);
                let expects = Expects::of(&request);
                (request.frame(), expects, Purpose::Survey, effect)
            }
            Errand::Stop(id) | Errand::Switch(id) | Errand::Drive(id) | Errand::Query(id) => {
                let motor = self.watch(now, id);
                let (request, control, sent) = next_request(motor, now, errand, tempo);
                let effect = Effect::Motor { id, control, sent };
                let expects = Expects::of(&request);
                (request.frame(), expects, Purpose::Control, effect)
            }
        };
        let [addressee, ..] = *frame.bytes();
        let motor = self.motors.iter().find(|motor| motor.id.get() == addressee);
        let mode = motor.and_then(|motor| motor.reads_drive_frames_in(now));
        self.handed_out = Some(HandedOut {
            at: now,
            frame,
            expects,
            purpose,
            mode,
            effect,
        });
        frame
    }

    /// The motor that is the most likely to answer, or `otherwise`.
    fn last_to_answer(&self, otherwise: MotorId) -> MotorId {
        let heard = self.motors.iter().filter(|motor| motor.ever_heard());
        let last = heard.max_by_key(|motor| motor.quiet_since());
        last.map_or(otherwise, |motor| motor.id)
    }

    /// Whether the next drive frame to this motor waits until a byte proves that the line carries the last.
    fn waits_for_proof(&self, now: Instant, id: MotorId) -> bool {
        let LastDrive::InFlight(since) = self.last_drive else {
            return false;
        };
        let motor = self.motors.iter().find(|motor| motor.id == id);
        match motor.map(|motor| motor.control) {
            // The port has refused one: it waits for the proof as well.
            _ if self.refused_in_a_row > 0 => true,
            Some(Control::Driven(driven)) if rests(driven.goal) => false,
            // Hold ends a motion: its first frame is offered at once, and each other behind a query.
            Some(Control::Driven(driven)) => match driven.hold.filter(|hold| hold.is_open(now)) {
                Some(hold) => !self.query_was_last && hold.began() <= since,
                None => true,
            },
            _ => false,
        }
    }

    /// The frame that was handed out last was taken: the next call of any kind says so.
    pub(crate) fn settle_handed_out(&mut self) {
        let Some(handed) = self.handed_out.take() else {
            return;
        };
        self.refused_in_a_row = 0;
        let HandedOut {
            at, frame, mode, ..
        } = handed;
        self.log(at, Passed::Sent { frame, mode });
        self.take_effect(&handed);
        self.begin_exchange(&handed);
    }

    /// The port did not take the frame that was handed out last; to be called before anything else.
    ///
    /// The log has it as not sent, and it has no effect: what was to be sent is still to be sent, a little
    /// later. For its motor it counts as unanswered, so that a port that takes nothing ends in withdrawn
    /// setpoints.
    pub fn unsent(&mut self) {
        let Some(handed) = self.handed_out.take() else {
            return;
        };
        let HandedOut { at, frame, .. } = handed;
        self.log(at, Passed::Unsent { frame });
        self.refused_in_a_row = self.refused_in_a_row.saturating_add(1);
        match handed.effect {
            // What a person wrote is not sent at a moment that the person did not choose.
            Effect::Raw => {
                self.take_effect(&handed);
                let raw = self.raw;
                self.count_refused(|id| raw.is_some_and(|raw| raw.may_move(id)));
                self.raw_answered(RawAnswer::NotSent);
            }
            Effect::Survey(errand) if self.refused_in_a_row < REFUSED_MAX => {
                self.survey_again = Some(errand);
            }
            Effect::Survey(Errand::SetId(_)) => self.cancel_survey(at),
            // A port that takes nothing for so long answers nothing.
            Effect::Survey(_) => {
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

    /// A frame to these motors was refused.
    fn count_refused(&mut self, concerns: impl Fn(MotorId) -> bool) {
        for motor in self.motors.iter_mut().filter(|motor| concerns(motor.id)) {
            motor.unanswered_in_a_row = motor.unanswered_in_a_row.saturating_add(1);
        }
    }

    fn take_effect(&mut self, handed: &HandedOut) {
        let now = handed.at;
        self.query_was_last = false;
        match handed.effect {
            Effect::IdQuery => self.id_query_wanted = false,
            Effect::Survey(_) => {}
            Effect::Raw => self.raw_goes_out(now),
            Effect::Motor { id, control, sent } => {
                let is_query = matches!(sent, Sent::Query(_));
                let mut stops_silent = None;
                let mut drives = false;
                let motor = self.watch(now, id);
                let is_first =
                    matches!(motor.control, Control::Stopping(stop) if !stop.first_frame_sent);
                motor.control = control;
                match sent {
                    Sent::Stop => {
                        stops_silent = motor.is_without_answer().then_some(is_first);
                    }
                    Sent::Switch { to, is_last } => {
                        if is_last {
                            // Ask whether it took.
                            motor.next_query = now;
                        }
                        motor.switch_sent(to);
                    }
                    Sent::Drive(setpoint) => {
                        drives = setpoint.is_some_and(|setpoint| !rests(setpoint));
                        motor.drive_frames.count(now);
                        if let Some(Setpoint::Current(current)) = setpoint {
                            motor.torque.sent(current);
                        }
                    }
                    Sent::Query(tempo) => {
                        motor.query_sent(now, tempo.query_period, tempo.others_driven);
                    }
                }
                if drives {
                    self.last_drive = LastDrive::InFlight(now);
                }
                if let Some(is_first) = stops_silent {
                    self.silent_firsts = if is_first { self.silent_firsts + 1 } else { 0 };
                    if !is_first || self.silent_firsts >= SILENT_FIRSTS_MAX {
                        self.silent_firsts = 0;
                        self.silent_stop_round = self.stop_round().map_or(0, |round| round + 1);
                    }
                }
                if is_query {
                    self.query_was_last = true;
                    self.queries_from = now + self.query_distance();
                }
            }
        }
    }

    fn begin_exchange(&mut self, handed: &HandedOut) {
        let &HandedOut {
            at,
            frame,
            expects,
            purpose,
            ..
        } = handed;
        let window = self.window(at, expects, purpose);
        let exchange = Exchange::begin(at, frame, expects, window, purpose);
        match expects {
            Expects::Reply { id, .. } => match self.motor_mut(id) {
                Some(motor) => motor.counters.requests += 1,
                None => self.counters.requests += 1,
            },
            Expects::Everyone { .. } => self.counters.requests += 1,
            Expects::Nothing => {}
        }
        self.line = Line::Busy(exchange);
    }

    /// How long the reply may take.
    fn window(&mut self, at: Instant, expects: Expects, purpose: Purpose) -> Duration {
        let (id, layout) = match expects {
            Expects::Reply { id, layout } => (id, layout),
            Expects::Everyone { layout: None } => return FIRST_WINDOW,
            Expects::Everyone { .. } | Expects::Nothing => return ID_QUERY_WINDOW,
        };
        if purpose == Purpose::Survey
            && let Some(window) = self.survey_window()
        {
            return window;
        }
        let own = self
            .motor_mut(id)
            .and_then(|motor| motor.round_trip.window());
        let window = own.or(self.round_trip.window()).unwrap_or(FIRST_WINDOW);
        // While any motor answers, the adapter is as fast as it was, and one that does not answer
        // costs the others no more than that. A query for a proof, a frame that holds and the stop of a
        // silent motor have no time to lose: a wheel goes on meanwhile. But where replies come late, the next request would meet one.
        let in_time = self
            .late_heard
            .is_none_or(|heard| at.since(heard) > LATE_FORGOTTEN);
        let unproved = matches!(self.last_drive, LastDrive::InFlight(_));
        let holds = self
            .motors
            .iter()
            .any(|motor| motor.id == id && motor.is_holding(at));
        let stops_silent = self.motors.iter().any(|motor| {
            let stops = matches!(motor.control, Control::Stopping(_));
            motor.id == id && stops && motor.is_without_answer()
        });
        let hurries = holds || stops_silent || (unproved && layout == Layout::Query);
        let doublings = if in_time && hurries {
            0
        } else {
            self.round_trip.doublings()
        };
        (window * (1 << doublings)).min(MAX_WINDOW)
    }
}
