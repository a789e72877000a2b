//! Stops: from the command to the report.

use motorlink_protocol::{Instant, MotorId};

use crate::{
    bus::Bus,
    event::{Event, StopOutcome, StopReason},
    exchange::Line,
    motor::{Control, Motor, Rest},
    standstill::Standstill,
    stop::{ActiveStop, Stopping},
    timing::{DRIVEN_SILENCE_MAX, stop_patience},
};

impl Bus {
    /// Stops every motor that is driven or may turn. Nothing drives until Release.
    pub(crate) fn stop_all(&mut self, now: Instant, reason: StopReason) {
        self.halted = true;
        self.begin_stop(now, reason, &|motor| {
            let active = !matches!(motor.control, Control::Idle);
            // A motor that is not certain to stand may turn. A motor that never answered does not exist.
            active || motor.may_turn() || (motor.has_answered() && !motor.stands(now))
        });
    }

    /// Brings the chosen motors to a standstill. The first frame is the next one on the wire.
    pub(crate) fn begin_stop(
        &mut self,
        now: Instant,
        reason: StopReason,
        // Not generic: it would be compiled once for each caller.
        concerns: &dyn Fn(&Motor) -> bool,
    ) {
        if reason != StopReason::Job {
            self.cancel_job(now);
        }
        // A repeated raw frame must not take the line from a stop.
        if let Some(raw) = &mut self.raw {
            raw.stop();
        }
        // All motors of a group stop together.
        let mut ids: Vec<MotorId> = self
            .motors
            .iter()
            .filter(|motor| concerns(motor))
            .map(|motor| motor.id)
            .collect();
        self.add_group_members(&mut ids);
        if self.stop.is_none() {
            self.silent_firsts = 0;
        }
        for motor in self
            .motors
            .iter_mut()
            .filter(|motor| ids.contains(&motor.id))
        {
            if let Control::Stopping(stop) = &mut motor.control {
                stop.restart_window(now);
                continue;
            }
            let (fresh, last) = motor.known_loop(now);
            motor.stops(Stopping::begin(now, fresh, last));
            // A wheel that stood until now may turn: only later angles count.
            motor.standstill = Standstill::default();
        }
        match &mut self.stop {
            Some(stop) => {
                stop.withdraw_group(&ids);
                stop.join(reason);
            }
            None => self.stop = Some(ActiveStop::new(reason)),
        }
        self.events.push_back(Event::StopBegan(reason));
        self.cut_exchange_short(now);
    }

    /// A stop waits for the reply in flight, but not for a motor that does not answer.
    pub(crate) fn cut_exchange_short(&mut self, now: Instant) {
        if let Line::Busy(exchange) = &mut self.line {
            let patience = (exchange.sent + stop_patience(self.model)).max(now);
            exchange.window_ends = exchange.window_ends.min(patience);
        }
    }

    /// Ends the stop when each motor stands or its stop window has ended. Until then all motors
    /// stay braked: releasing one while another still brakes would turn the vehicle.
    pub(crate) fn end_stop(&mut self, now: Instant) {
        let under_way = |motor: &Motor| match &motor.control {
            Control::Stopping(stop) => !stop.is_over(now),
            _ => false,
        };
        if self.stop.is_none() || self.motors.iter().any(under_way) {
            return;
        }
        let mut outcomes = Vec::new();
        let mut starts = Vec::new();
        for motor in &mut self.motors {
            if let Control::Stopping(stop) = motor.control {
                let confirmed = stop.confirmed();
                // A motor that was never driven and never answers does not begin to turn by it.
                if confirmed {
                    motor.rest = Rest::Known;
                } else if now.since(motor.silent_since()) >= DRIVEN_SILENCE_MAX {
                    motor.was_not_reached();
                }
                motor.control = Control::Idle;
                let speed = motor.fresh_speed(now);
                let outcome = StopOutcome {
                    id: motor.id,
                    confirmed,
                    speed,
                };
                starts.extend(stop.then.map(|start| (outcome, start)));
                outcomes.push(outcome);
            }
        }
        self.stop_for_job_ended(&outcomes);
        let Some(stop) = self.stop.take() else {
            return;
        };
        let group = stop.then_group;
        let report = stop.report(outcomes.clone());
        self.events.push_back(Event::StopEnded(report));
        for (outcome, start) in starts {
            self.start_stopped(now, outcome, start);
        }
        if let Some(group) = group {
            self.start_stopped_group(now, &outcomes, group);
        }
    }
}
