//! What is sent.

use std::time::Duration;

use motorlink_protocol::{Frame, Instant, Request};

use super::{Bus, surveying::request_of};
use crate::{
    Passed, Ramp,
    exchange::{Exchange, Expects, Line, Purpose},
    mode_switch::Switch,
    motor::{Control, Driven, Motor},
    safety::step_towards,
    schedule::Errand,
    timing::{
        CATCH_UP_MAX, DRIVEN_UNANSWERED_MAX, FIRST_WINDOW, ID_QUERY_WINDOW, MAX_WINDOW,
        SILENT_STOP_PERIOD, STOP_PERIOD,
    },
};

impl Bus {
    /// Begins the exchange of an errand and hands out its frame.
    pub(super) fn speak(&mut self, now: Instant, errand: Errand) -> Frame {
        self.sort_unasked_bytes(now);
        let tempo = Tempo {
            period: self.rate.period(),
            query_period: self.query_period(),
            ramp: self.ramp,
            others_driven: self.anyone_driven(),
        };
        self.query_was_last = matches!(errand, Errand::Query(_));
        if self.query_was_last {
            self.queries_from = now + self.query_distance();
        }
        let (request, purpose) = match errand {
            Errand::Raw => return self.speak_raw(now),
            Errand::IdQuery => {
                self.id_query_wanted = false;
                (Request::IdQuery, Purpose::Control)
            }
            Errand::Survey(ask) => (request_of(ask), Purpose::Survey),
            Errand::SetId(id) => (Request::SetId { id }, Purpose::Survey),
            Errand::Stop(id) | Errand::Switch(id) | Errand::Drive(id) | Errand::Query(id) => {
                let motor = self.watch(now, id);
                (next_request(motor, now, errand, tempo), Purpose::Control)
            }
        };
        self.begin_exchange(now, request.frame(), Expects::of(&request), purpose)
    }

    /// Sends what a person wrote, as it is.
    fn speak_raw(&mut self, now: Instant) -> Frame {
        // Without a frame nothing would be due; the ID query harms nobody.
        let frame = self.raw.map_or(Request::IdQuery.frame(), |raw| raw.frame);
        self.raw_goes_out(now);
        self.begin_exchange(now, frame, Expects::of_raw(&frame), Purpose::Raw)
    }

    fn begin_exchange(
        &mut self,
        now: Instant,
        frame: Frame,
        expects: Expects,
        purpose: Purpose,
    ) -> Frame {
        let exchange = Exchange::begin(now, frame, expects, self.window(expects, purpose), purpose);
        match expects {
            Expects::Reply { id, .. } => match self.motor_mut(id) {
                Some(motor) => motor.counters.requests += 1,
                None => self.counters.requests += 1,
            },
            Expects::Everyone { .. } => self.counters.requests += 1,
            Expects::Nothing => {}
        }
        let [addressee, ..] = *frame.bytes();
        let motor = self.motors.iter().find(|motor| motor.id.get() == addressee);
        let mode = motor.and_then(|motor| motor.reads_drive_frames_in(now));
        self.log(now, Passed::Sent { frame, mode });
        self.line = Line::Busy(exchange);
        frame
    }

    /// How long the reply may take.
    fn window(&mut self, expects: Expects, purpose: Purpose) -> Duration {
        let id = match expects {
            Expects::Reply { id, .. } => id,
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
        // costs the others no more than that.
        (window * (1 << self.round_trip.doublings())).min(MAX_WINDOW)
    }
}

/// How often, and how fast.
#[derive(Clone, Copy)]
struct Tempo {
    /// Between two drive frames to one motor.
    period: Duration,
    /// Between two queries of one motor that answers.
    query_period: Duration,
    ramp: Option<Ramp>,
    others_driven: bool,
}

/// The request that an errand means now, with the motor's schedule moved on.
fn next_request(motor: &mut Motor, now: Instant, errand: Errand, tempo: Tempo) -> Request {
    let id = motor.id;
    let period = tempo.period;
    let stop_period = if tempo.others_driven && motor.unanswered_in_a_row >= DRIVEN_UNANSWERED_MAX {
        SILENT_STOP_PERIOD
    } else {
        STOP_PERIOD
    };
    match (&mut motor.control, errand) {
        (Control::Stopping(stop), Errand::Stop(_)) => {
            let request = stop.next_request(now, id);
            stop.sent(now, &request, stop_period);
            request
        }
        (Control::Switching(switch), Errand::Switch(_)) => {
            switch.frame_sent(now);
            let to = switch.to;
            if switch.next_frame().is_none() {
                // The fifth was sent: ask whether it took.
                motor.next_query = now;
            }
            motor.switch_sent(to);
            Request::SwitchMode { id, mode: to }
        }
        (Control::Driven(driven), Errand::Drive(_)) => {
            let goal = step_towards(driven.goal, driven.on_the_wire);
            let mut ramped = driven.ramped;
            let setpoint = ramped.step(now, goal, tempo.ramp, period);
            let (on_schedule, next_frame) = kept_schedule(driven.on_schedule, now, period);
            *driven = Driven {
                ramped,
                on_schedule,
                on_the_wire: Some(setpoint),
                next_frame,
                ..*driven
            };
            motor.drive_frames.count(now);
            Request::drive(id, setpoint)
        }
        (
            Control::Switching(Switch {
                meanwhile: Some(meanwhile),
                ..
            }),
            Errand::Drive(_),
        ) => {
            meanwhile.next_frame = next_on_schedule(meanwhile.next_frame, now, period);
            motor.drive_frames.count(now);
            Request::Drive {
                id,
                drive: meanwhile.drive,
            }
        }
        _ => {
            motor.query_sent(now, tempo.query_period, tempo.others_driven);
            Request::Query { id }
        }
    }
}

/// When the frame behind the one that is sent now belongs, and when it may go out: what was held up a
/// little is made up for, two frames being half a period apart at least, so that a rate is kept on a
/// busy machine. More than [`CATCH_UP_MAX`] is given up.
fn kept_schedule(on_schedule: Instant, now: Instant, period: Duration) -> (Instant, Instant) {
    // A command that shows at once begins the schedule anew.
    let next = (on_schedule.min(now) + period).max(now - CATCH_UP_MAX);
    (next, next.max(now + period / 2))
}

/// A period after the last deadline, so that lateness does not add up; but where the line could not
/// keep the schedule, no burst makes up for it.
fn next_on_schedule(deadline: Instant, now: Instant, period: Duration) -> Instant {
    (deadline + period).max(now + period / 2)
}
