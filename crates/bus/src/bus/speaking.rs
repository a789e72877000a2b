//! What is sent.

use std::time::Duration;

use motorlink_protocol::{Frame, Instant, Request};

use super::Bus;
use crate::{
    exchange::{Exchange, Expects, Line},
    mode_switch::Switch,
    motor::{Control, Driven, Motor},
    safety::step_towards,
    schedule::Errand,
    timing::{FIRST_WINDOW, ID_QUERY_WINDOW, MAX_WINDOW},
};

impl Bus {
    /// Begins the exchange of an errand and hands out its frame.
    pub(super) fn speak(&mut self, now: Instant, errand: Errand) -> Frame {
        self.sort_unasked_bytes(now);
        let period = self.rate.period();
        let request = match errand {
            Errand::IdQuery => {
                self.id_query_wanted = false;
                Request::IdQuery
            }
            Errand::Stop(id) | Errand::Switch(id) | Errand::Drive(id) | Errand::Query(id) => {
                let motor = self.watch(now, id);
                next_request(motor, now, errand, period)
            }
        };
        let exchange = Exchange::begin(now, &request, self.window(&request));
        match exchange.expects {
            Expects::Reply { id, .. } => self.watch(now, id).counters.requests += 1,
            Expects::Everyone => self.counters.requests += 1,
            Expects::Nothing => {}
        }
        self.line = Line::Busy(exchange);
        exchange.frame
    }

    /// How long the reply may take.
    fn window(&mut self, request: &Request) -> Duration {
        let Some(id) = request.addressee() else {
            return ID_QUERY_WINDOW;
        };
        let own = self
            .motor_mut(id)
            .and_then(|motor| motor.round_trip.window());
        let window = own.or(self.round_trip.window()).unwrap_or(FIRST_WINDOW);
        // While any motor answers, the adapter is as fast as it was, and one that does not answer
        // costs the others no more than that.
        (window * (1 << self.round_trip.doublings())).min(MAX_WINDOW)
    }
}

/// The request that an errand means now, with the motor's schedule moved on.
fn next_request(motor: &mut Motor, now: Instant, errand: Errand, period: Duration) -> Request {
    let id = motor.id;
    match (&mut motor.control, errand) {
        (Control::Stopping(stop), Errand::Stop(_)) => {
            let request = stop.next_request(now, id);
            stop.sent(now, &request);
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
            let setpoint = step_towards(driven.goal, driven.on_the_wire);
            *driven = Driven {
                on_the_wire: Some(setpoint),
                next_frame: next_on_schedule(driven.next_frame, now, period),
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
            motor.query_sent(now);
            Request::Query { id }
        }
    }
}

/// A period after the last deadline, so that lateness does not add up; but where the line could not
/// keep the schedule, no burst makes up for it.
fn next_on_schedule(deadline: Instant, now: Instant, period: Duration) -> Instant {
    (deadline + period).max(now + period / 2)
}
