//! How long the bus waits for a reply.

use std::time::Duration;

use motorlink_protocol::{Instant, family::Layout};

use crate::{
    bus::{Bus, LastDrive},
    exchange::{Expects, Purpose},
    motor::{Control, Motor},
    timing::{FIRST_WINDOW, ID_QUERY_WINDOW, MAX_WINDOW, stop_patience},
};

impl Bus {
    /// How long the bus waits for the reply.
    pub(crate) fn reply_window(&self, at: Instant, expects: Expects, purpose: Purpose) -> Duration {
        let (id, layout) = match expects {
            Expects::Reply { id, layout } => (id, layout),
            Expects::Everyone { layout: None } => return FIRST_WINDOW,
            Expects::Everyone { .. } | Expects::Nothing => return ID_QUERY_WINDOW,
        };
        if purpose == Purpose::Job
            && let Some(window) = self.job_window()
        {
            return window;
        }
        let motor = self.motors.iter().find(|motor| motor.id == id);
        let own = motor.and_then(|motor| motor.round_trip.window());
        let window = own.or(self.round_trip.window()).unwrap_or(FIRST_WINDOW);
        // While another motor answers, the adapter is not slower than before, so a silent motor
        // costs the others no longer window. A query for proof, a hold, the stop of a silent
        // motor and queries for an old temperature are urgent: the wheel turns meanwhile. But if replies come late, a short window
        // would let the next request collide with one.
        let in_time = at > self.late_until;
        let unproved = matches!(self.last_drive, LastDrive::InFlight(_));
        let driven = self.motors.iter().filter(|motor| motor.is_driven()).count();
        let driven = u32::try_from(driven).unwrap_or(u32::MAX);
        let is_urgent = |motor: &Motor| {
            let stops = matches!(motor.control, Control::Stopping(_));
            motor.is_holding(at)
                || (stops && motor.is_without_answer())
                || motor.asks_instead_until(at, driven).is_some()
        };
        let hurries = motor.is_some_and(is_urgent) || (unproved && layout == Layout::Query);
        let doublings = if in_time && hurries {
            0
        } else {
            self.round_trip.doublings()
        };
        // A motor without an answer gains nothing by a longer window, and the others lose it.
        let is_heard = motor.is_some_and(|motor| !motor.is_without_answer());
        let mut window = window * (1 << doublings);
        if is_heard {
            window = window.max(self.late_window.at(at));
        }
        let window = window.min(MAX_WINDOW);
        // While another motor waits for its first brake, a reply may come late: the line is free once it has passed.
        let brake_waits = self.motors.iter().any(|motor| match motor.control {
            Control::Stopping(stop) => {
                let may_brake_soon = stop.waits_for_brake() && !motor.is_without_answer();
                motor.id != id && (stop.last_sent().is_none() || may_brake_soon)
            }
            _ => false,
        });
        if brake_waits {
            window.min(stop_patience(self.model))
        } else {
            window
        }
    }
}
