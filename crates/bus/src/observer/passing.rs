//! What time alone changes: setpoints, switches and stops end, motors fall silent.

use std::time::Duration;

use motorlink_protocol::{Faults, Instant};

use super::Observer;
use crate::{
    exchange::{Exchange, Expects, Line},
    line_use::Use,
    mode_switch::Progress,
    motor::{Control, Motor},
    supervision::after_switch,
    timing::STOP_WINDOW,
};

/// How long a drive frame counts as the command. At the lowest command rate, 1 Hz, the next one comes after a second;
/// the rest is for a delayed line.
const DRIVES_FOR: Duration = Duration::from_millis(1_500);

/// A motor that gets no frame for this long, while others get some, is not watched any more: a silent motor is queried
/// every eight seconds.
const FORGOTTEN_AFTER: Duration = Duration::from_secs(20);

impl Observer {
    /// Passes to this time, after the last event before it.
    pub(super) fn pass_to(&mut self, now: Instant) {
        if let Some((at, bytes)) = self.junk.take() {
            self.junk_ends(at, bytes);
        }
        self.advance(now);
        self.bus.events.clear();
    }

    pub(super) fn advance(&mut self, now: Instant) {
        if let Line::Busy(exchange) = self.bus.line
            && exchange.expects == Expects::Nothing
            && now >= exchange.window_ends
        {
            self.rested(exchange.window_ends, &exchange);
        }
        let heard = &self.heard;
        for motor in &mut self.bus.motors {
            motor.silent |= now >= motor.silent_at();
            let drove = heard.iter().find(|heard| heard.id == motor.id);
            let drove = drove.map_or(Instant::ZERO, |heard| heard.drove);
            motor.control = control_at(now, motor, drove);
        }
        // All motors of a stop are braked until the last one stands.
        let is_under_way = |motor: &Motor| match motor.control {
            Control::Stopping(stop) => !stop.is_over(now),
            _ => false,
        };
        if self.bus.motors.iter().any(is_under_way) {
            return;
        }
        for motor in &mut self.bus.motors {
            if let Control::Stopping(_) = motor.control {
                motor.control = Control::Idle;
            }
        }
        if self.bus.stop.is_some()
            && self
                .heard
                .iter()
                .all(|heard| now.since(heard.drove) > STOP_WINDOW)
        {
            self.bus.stop = None;
        }
    }

    /// An exchange without a reply, or a pause, has ended.
    pub(super) fn rested(&mut self, at: Instant, exchange: &Exchange) {
        self.bus.line = Line::Free {
            last: exchange.frame,
        };
        let took = at.since(exchange.sent);
        self.bus.line_use.add(at, Use::Other, took);
        self.bus.freed_at = at;
    }

    /// Forgets motors that the bus does not watch any more.
    pub(super) fn forget_those_not_asked(&mut self, now: Instant) {
        let is_watched = |asked: Instant| now.since(asked) <= FORGOTTEN_AFTER;
        if self.heard.iter().all(|heard| is_watched(heard.asked)) {
            return;
        }
        self.heard.retain(|heard| is_watched(heard.asked));
        let heard = &self.heard;
        self.bus
            .motors
            .retain(|motor| heard.iter().any(|heard| heard.id == motor.id));
    }
}

/// What is done with a motor at this time, if its last drive frame was sent at `drove`.
fn control_at(now: Instant, motor: &Motor, drove: Instant) -> Control {
    match motor.control {
        Control::Driven(_) if now.since(drove) > DRIVES_FOR => Control::Idle,
        Control::Switching(switch) => match switch.progress(now) {
            Progress::Confirmed if !motor.loop_is_unconfirmed() || now >= switch.fails_at() => {
                let faulty = motor.fresh_faults(now).is_some_and(Faults::any_named);
                after_switch(now, &switch, motor.fresh_speed(now), faulty)
            }
            // Also a switch by hand of fewer frames.
            _ if now >= switch.fails_at() => Control::Idle,
            _ => motor.control,
        },
        control => control,
    }
}
