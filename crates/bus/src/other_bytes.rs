//! Bytes that are not the reply that the bus waits for: late replies, echoes and junk.

use motorlink_protocol::{FRAME_LEN, Instant, family::Reading};

use crate::{
    bus::Bus,
    counters::Counters,
    exchange::{Exchange, Expects, Line},
    model::foreign_text::Text,
    motor::Motor,
    receiver::{OtherBytes, ReceivedReply, Segment},
    timing::LATE_FORGOTTEN,
};

impl Bus {
    /// Processes bytes that arrived without a request in flight: late replies, and echoes of frames
    /// that have no reply.
    pub(crate) fn process_unrequested_bytes(&mut self, now: Instant) {
        let Line::Free { last } = self.line else {
            return;
        };
        let rest = self.receiver.clear(&last);
        count_line(&mut self.counters, &rest);
        self.log_and_record(now, &rest);
        self.handle_foreign_frames(now, &rest);
    }

    /// Counts and logs the bytes beside a reply or instead of one.
    pub(crate) fn process_other_bytes(
        &mut self,
        now: Instant,
        exchange: &Exchange,
        rest: &OtherBytes,
    ) {
        let counters = match exchange.expects {
            Expects::Reply { id, .. } => self.motor_mut(id).map(|motor| &mut motor.counters),
            Expects::Everyone { .. } | Expects::Nothing => None,
        };
        match counters {
            Some(counters) => count_line(counters, rest),
            None => count_line(&mut self.counters, rest),
        }
        self.log_and_record(now, rest);
        self.handle_foreign_frames(now, rest);
    }

    /// Logs the bytes beside the expected reply and records the good frames among them.
    fn log_and_record(&mut self, now: Instant, rest: &OtherBytes) {
        for piece in &rest.segments {
            match piece {
                Segment::Reply(received) => {
                    // Beside junk it may be a frame by chance.
                    let is_certain = rest.junk_bytes == 0 && !rest.is_block;
                    self.receive_late_reply(now, *received, is_certain);
                }
                Segment::Junk(junk) => self.log_junk(now, *junk),
            }
        }
    }

    /// Processes a good frame outside its window. The request is uncertain, so bytes 6 and 7 stay
    /// undetermined. A frame that is not certain is counted and tells nothing.
    pub(crate) fn receive_late_reply(
        &mut self,
        now: Instant,
        received: ReceivedReply,
        is_certain: bool,
    ) {
        let ReceivedReply { frame, reading } = received;
        let id = reading.id();
        self.log_received(now, &frame, None);
        self.late_until = now + LATE_FORGOTTEN;
        self.job_late_reply(now, id);
        let expected = |motor: &Motor| motor.id == id && motor.late.may_come(now);
        let Some(motor) = self.motors.iter_mut().find(|motor| expected(motor)) else {
            self.counters.wrong_ids += 1;
            return;
        };
        motor.counters.late += 1;
        motor.loss.answered_late();
        if let Some(sent) = motor.late.newest(now).filter(|_| is_certain) {
            self.late_window.widen(now, sent);
        }
        let oldest = motor.late.oldest(now);
        motor.late.late_reply();
        if is_certain && self.stop_takes_late_reply(now, oldest, &reading) {
            return;
        }
        let Some(motor) = self.motor_mut(id) else {
            return;
        };
        let Reading::Combined(reply) = reading else {
            // Of unknown age: it may name the loop before a switch.
            motor.separate.unanswered(false);
            motor.count_reply();
            return;
        };
        if !is_certain || motor.late.may_answer_id_query() {
            motor.count_reply();
        } else if motor.late.makes_round_trip_ambiguous(now) {
            self.record_reply(now, reply);
        } else {
            motor.record_reply_of_unknown_age(&reply);
        }
    }
}

pub(crate) fn count_line(counters: &mut Counters, rest: &OtherBytes) {
    match rest.echoed {
        0 => {}
        FRAME_LEN => counters.echoes_whole += 1,
        _ => counters.echoes_cut += 1,
    }
    counters.junk_bytes += rest.junk_bytes as u64;
    if rest.is_levels() {
        counters.level_bytes += rest.junk_bytes as u64;
    } else if rest.text.is_some_and(Text::is_long) {
        counters.text_bytes += rest.junk_bytes as u64;
    }
}
