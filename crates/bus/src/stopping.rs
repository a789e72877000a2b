//! Stops: from the command to the report.

use motorlink_protocol::{Instant, MotorId};

use crate::{
    bus::Bus,
    event::{Event, StopOutcome, StopReason},
    exchange::Line,
    motor::{Control, Motor},
    stop::{ActiveStop, Stopping},
    timing::STOP_PATIENCE,
};

impl Bus {
    /// Stops whatever was driven or turns, and drives nothing until released.
    pub(crate) fn stop_all(&mut self, now: Instant, reason: StopReason) {
        self.halted = true;
        self.begin_stop(now, reason, |motor| {
            let active = !matches!(motor.control, Control::Idle);
            // A wheel that reports no speed may turn; one that never answered is not there.
            let stands = motor
                .fresh_speed(now)
                .is_some_and(|speed| speed.magnitude() == 0);
            active || motor.may_turn || (motor.ever_heard() && !stands)
        });
    }

    /// Brings the chosen motors to a standstill, beginning with the next frame on the wire.
    pub(crate) fn begin_stop(
        &mut self,
        now: Instant,
        reason: StopReason,
        concerns: impl Fn(&Motor) -> bool,
    ) {
        if reason != StopReason::Survey {
            self.cancel_survey(now);
        }
        // Whatever a person repeats, it must not take the line from a stop.
        if let Some(raw) = &mut self.raw {
            raw.stop();
        }
        // None of a group goes on without the others.
        let mut ids: Vec<MotorId> = self
            .motors
            .iter()
            .filter(|motor| concerns(motor))
            .map(|motor| motor.id)
            .collect();
        self.add_companions(&mut ids);
        if self.stop.is_none() {
            self.silent_stop_round = 0;
            self.silent_firsts = 0;
        }
        let round = self.stop_round().unwrap_or(0);
        for motor in self
            .motors
            .iter_mut()
            .filter(|motor| ids.contains(&motor.id))
        {
            if let Control::Stopping(stop) = &mut motor.control {
                stop.asked_again(now);
                continue;
            }
            let (fresh, last) = motor.known_loop(now);
            motor.stops(Stopping::begin(now, fresh, last, round));
        }
        match &mut self.stop {
            Some(stop) => stop.join(reason),
            None => self.stop = Some(ActiveStop::new(reason)),
        }
        self.events.push_back(Event::StopBegan(reason));
        self.cut_exchange_short(now);
    }

    /// The frames of their stop that all motors which answer have got; `None` where none is stopped.
    pub(crate) fn stop_round(&self) -> Option<u32> {
        let rounds = self.motors.iter().filter_map(|motor| match &motor.control {
            Control::Stopping(stop) if !motor.is_without_answer() => Some(stop.round),
            _ => None,
        });
        rounds.min()
    }

    /// A stop waits for the exchange in flight, but not for a motor that does not answer.
    pub(crate) fn cut_exchange_short(&mut self, now: Instant) {
        if let Line::Busy(exchange) = &mut self.line {
            let patience = (exchange.sent + STOP_PATIENCE).max(now);
            exchange.window_ends = exchange.window_ends.min(patience);
        }
    }

    /// Ends the stop when each of its motors stands or has spent its window. Until then all of them
    /// stay braked: a wheel let go while another still brakes would turn the vehicle.
    pub(crate) fn end_stop(&mut self, now: Instant) {
        let under_way = |motor: &Motor| match &motor.control {
            Control::Stopping(stop) => !stop.over(now),
            _ => false,
        };
        if self.stop.is_none() || self.motors.iter().any(under_way) {
            return;
        }
        let mut outcomes = Vec::new();
        for motor in &mut self.motors {
            if let Control::Stopping(stop) = motor.control {
                let confirmed = stop.confirmed();
                motor.may_turn = !confirmed;
                motor.control = Control::Idle;
                let speed = motor.fresh_speed(now);
                outcomes.push(StopOutcome {
                    id: motor.id,
                    confirmed,
                    speed,
                });
            }
        }
        self.way_was_made(&outcomes);
        if let Some(stop) = self.stop.take() {
            self.events
                .push_back(Event::StopEnded(stop.report(outcomes)));
        }
    }
}
