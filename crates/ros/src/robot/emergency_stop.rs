//! Emergency stop and reset.

use std::{
    thread,
    time::{Duration, Instant},
};

use motorlink_controller_messages::{Activity, Motor};

use super::{NOT_CONFIRMED, Robot, STEP, STOP_MAX};
use crate::{
    motorlink,
    network::Input,
    node::{Request, messages::TriggerResponse},
    say,
};

/// A wheel that turns no faster stands: 2 rpm, in which a speed is told.
const AT_REST_RAD_PER_S: f32 = 0.22;

impl Robot {
    /// Takes what has to do with emergency stops.
    pub(super) fn take_stop(&mut self, input: Input) {
        let now = Instant::now();
        match input {
            Input::EStop(request) => {
                self.stop_all();
                self.drive.e_stop();
                self.step();
                self.e_stops += 1;
                self.stops.push((now + STOP_MAX, request));
                say("emergency stop");
            }
            Input::StopSent(Ok(())) => self.stop_sent = Some(now),
            Input::StopSent(Err(error)) => {
                let message = format!("NOT STOPPED: {error:#}. The power switch stops the motors");
                say(&message);
                for (_, request) in self.stops.drain(..) {
                    reply(request, false, &message);
                }
            }
            Input::Reset(request) if !self.stops.is_empty() => {
                reply(request, false, "not released: the motors are being stopped");
            }
            Input::Reset(request) => {
                let (socket, to) = (self.socket.clone(), self.to.clone());
                let before = self.e_stops;
                thread::spawn(move || {
                    let answer = motorlink::release(&socket);
                    // The program may have ended.
                    let _ = to.send(Input::ResetSent(answer, request, before));
                });
            }
            // The release may have come after the stop.
            Input::ResetSent(_, request, before) if before != self.e_stops => {
                self.stop_all();
                reply(
                    request,
                    false,
                    "not released: there is a newer emergency stop",
                );
            }
            Input::ResetSent(Ok(()), request, _) => {
                self.drive.reset(now);
                say("reset after an emergency stop");
                reply(
                    request,
                    true,
                    "released: drives after cmd_vel has rested for 2 s",
                );
            }
            Input::ResetSent(Err(error), request, _) => {
                reply(request, false, &format!("not released: {error:#}"));
            }
            _ => {}
        }
    }

    /// Stops all motors, also those that a page or another program drives.
    fn stop_all(&mut self) {
        self.stop_sent = None;
        let (socket, to) = (self.socket.clone(), self.to.clone());
        thread::spawn(move || {
            let until = Instant::now() + STOP_MAX / 2;
            let mut stopped = motorlink::stop_all(&socket);
            while stopped.is_err() && Instant::now() < until {
                thread::sleep(10 * STEP);
                stopped = motorlink::stop_all(&socket);
            }
            // The program may have ended.
            let _ = to.send(Input::StopSent(stopped));
        });
    }

    /// Whether every motor of the rover is known to stand, by a reply since then.
    fn stands(&self, since: Instant) -> bool {
        let Some((at, _, state)) = &self.state else {
            return false;
        };
        if !state.is_open || !state.is_halted {
            return false;
        }
        // The state was sent a moment before it came.
        let elapsed = at.saturating_duration_since(since).saturating_sub(2 * STEP);
        let is_since = |age: u32| Duration::from_micros(age.into()) < elapsed;
        let replied = |motor: &Motor| motor.reply_age.is_some_and(is_since);
        let is_at_rest = |motor: &Motor| {
            let velocity = motor.velocity;
            velocity
                .is_some_and(|(velocity, age)| velocity.abs() < AT_REST_RAD_PER_S && is_since(age))
        };
        self.rover.wheels.iter().all(|wheel| {
            let mut motors = state.motors.iter();
            motors
                .find(|motor| motor.id == wheel.id.get())
                .is_some_and(|motor| {
                    motor.activity == Activity::Idle
                        && !motor.may_turn
                        && replied(motor)
                        && is_at_rest(motor)
                })
        })
    }

    /// Answers emergency stops once the motors stand, or have not stood in time.
    pub(super) fn answer_stops(&mut self, now: Instant) {
        let stands = self.stop_sent.is_some_and(|sent| self.stands(sent));
        let mut waiting = Vec::new();
        for (until, request) in self.stops.drain(..) {
            if stands {
                reply(request, true, "the motors stand, confirmed");
            } else if now >= until {
                say(NOT_CONFIRMED);
                reply(request, false, NOT_CONFIRMED);
            } else {
                waiting.push((until, request));
            }
        }
        self.stops = waiting;
    }
}

/// Answers a request. The network may take its time.
fn reply(request: Request, success: bool, message: &str) {
    let message = message.to_owned();
    thread::spawn(move || request.answer(&TriggerResponse { success, message }));
}
