//! The end of a reply window: the exchange in flight has had no reply.

use motorlink_protocol::{FRAME_LEN, Instant, MotorId, family::Layout};

use crate::{
    bus::{Bus, LastDrive},
    exchange::{Exchange, Expects, Line, Purpose},
    job::state::Job,
    line_event::LineEventKind,
    line_use::Use,
    motor::{Control, Motor},
    probe::ProbeResult,
    raw::status::RawAnswer,
    receiver::OtherBytes,
    timing::{DRIVEN_UNANSWERED_MAX, micros},
};

impl Bus {
    /// Ends the exchange in flight if its reply window has ended.
    pub(crate) fn end_spent_window(&mut self, now: Instant) {
        let Line::Busy(exchange) = self.line else {
            return;
        };
        if now < exchange.window_ends {
            return;
        }
        self.line = Line::Free {
            last: exchange.frame,
        };
        let what = match exchange.expects {
            Expects::Reply { .. } => Use::Waiting,
            Expects::Everyone { .. } | Expects::Nothing => Use::Other,
        };
        self.line_use.add(now, what, now.since(exchange.sent));
        self.freed_at = now;
        if exchange.expects == Expects::Nothing {
            if exchange.purpose == Purpose::Raw {
                self.raw_answered(RawAnswer::NoneExpected);
            }
            // Late replies that came meanwhile may withdraw a setpoint. Of its echo, the rest may
            // still arrive; those bytes are processed before the next frame.
            self.look_for_reply(now);
            return;
        }
        let is_doubtful = self.receiver.has_doubtful_copy(&exchange.frame);
        self.receiver.window_ended(&exchange.frame);
        let rest = self.receiver.clear(&exchange.frame);
        match exchange.expects {
            Expects::Nothing => {}
            Expects::Everyone { layout } => {
                self.broadcast_window_ended(now, &exchange, layout, &rest);
            }
            Expects::Reply { id, layout } => {
                self.process_other_bytes(now, &exchange, &rest);
                self.unanswered(now, &exchange, id, layout, &rest, is_doubtful);
            }
        }
    }

    /// The reply window of one motor has ended without its reply. `is_doubtful` if a copy of the request may be the reply.
    pub(crate) fn unanswered(
        &mut self,
        now: Instant,
        exchange: &Exchange,
        id: MotorId,
        layout: Layout,
        rest: &OtherBytes,
        is_doubtful: bool,
    ) {
        let waited_us = micros(now.since(exchange.sent));
        match exchange.purpose {
            // A motor that was silent before tells nothing about the adapter, unless all motors are
            // silent.
            Purpose::Control if self.may_mean_slow_adapter(now, exchange, id) => {
                self.round_trip.lost();
            }
            Purpose::Control | Purpose::Pause => {}
            Purpose::Job if rest.is_quiet() && !is_doubtful => {
                if let Some(Job::Scan(scan)) = &mut self.job
                    && rest.junk_bytes > 0
                {
                    scan.heard_levels();
                }
                self.job_probe_ended(now, exchange.sent, id, ProbeResult::Silence);
            }
            Purpose::Job => self.job_probe_ended(now, exchange.sent, id, ProbeResult::Noise),
            Purpose::Raw if rest.is_silence() => {
                self.raw_answered(RawAnswer::Silence { waited_us });
            }
            Purpose::Raw => self.raw_answered(RawAnswer::Garbled),
        }
        // A scan expects most addresses to be silent.
        if rest.is_silence() && !matches!(self.job, Some(Job::Scan(_))) {
            self.log(now, LineEventKind::Silence { id, waited_us });
        }
        let counters = match self.motors.iter_mut().find(|motor| motor.id == id) {
            Some(motor) => {
                let layout = layout.combined();
                motor.lost(
                    now,
                    layout.unwrap_or(motorlink_protocol::Layout::Query),
                    exchange.sent,
                );
                motor.loss.count(true);
                if is_doubtful {
                    // The two kinds of queries alternate, and the answer to the other one differs from its request.
                    motor.next_query = now;
                }
                // A good reply of another motor says nothing of this one.
                motor.record_lost_window(rest.junk_bytes > 0);
                if let Control::Stopping(stop) = &mut motor.control
                    && self.settings.slow_brake_frames
                {
                    stop.unanswered(now);
                }
                &mut motor.counters
            }
            None => &mut self.counters,
        };
        match rest.junk_bytes {
            0 => counters.silences += 1,
            1..FRAME_LEN => counters.fragments += 1,
            _ => counters.bad_crcs += 1,
        }
        if let LastDrive::InFlight(_) = self.last_drive {
            // The query stood for the drive frames that wait for proof: their motors did not answer
            // either.
            for motor in self.motors.iter_mut().filter(|motor| motor.id != id) {
                if let Control::Driven(_) = motor.control {
                    motor.unanswered_in_a_row = motor.unanswered_in_a_row.saturating_add(1);
                }
            }
        }
    }

    /// Whether a lost reply of this motor may mean a slower adapter. A stop does not wait for all of it.
    fn may_mean_slow_adapter(&self, now: Instant, exchange: &Exchange, id: MotorId) -> bool {
        if now.since(exchange.sent) < self.round_trip.usual() {
            return false;
        }
        let was_silent = |motor: &Motor| motor.unanswered_in_a_row >= DRIVEN_UNANSWERED_MAX;
        let motor = self.motors.iter().find(|motor| motor.id == id);
        let other_answers = |motor: &Motor| motor.id != id && motor.fresh_speed(now).is_some();
        !motor.is_some_and(was_silent) || !self.motors.iter().any(other_answers)
    }
}
