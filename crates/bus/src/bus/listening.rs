//! What is heard.

use motorlink_protocol::{Detail, FRAME_LEN, Frame, Instant, Layout, MotorId, Reply, Setpoint};

use super::Bus;
use crate::{
    Counters, Event, IdQueryOutcome, Sample,
    exchange::{Exchange, Expects, Line},
    motor::{Control, Motor},
    receiver::{Found, Leftovers},
    timing::{AMBIGUITY_QUIET, EARLIEST_REPLY},
};

/// Junk that may stand beside one clean reply to the ID query: less than half a frame is noise, more
/// is another motor's voice.
const STRAY_BYTES_MAX: usize = 4;

impl Bus {
    /// Takes bytes that the port delivered.
    pub fn receive(&mut self, now: Instant, bytes: &[u8]) {
        self.receiver.push(bytes);
        if let Line::Busy(exchange) = &mut self.line {
            exchange.held_until = exchange.held_until.map(|_| now + AMBIGUITY_QUIET);
        }
        self.look_for_reply(now);
    }

    /// Ends the exchange in flight if its reply is there.
    pub(super) fn look_for_reply(&mut self, now: Instant) {
        while let Line::Busy(exchange) = self.line
            && let Expects::Reply { id, layout } = exchange.expects
        {
            let settled = now >= exchange.deadline();
            match self.receiver.find(id, settled) {
                Found::Nothing => return,
                Found::Ambiguous => {
                    if let Line::Busy(exchange) = &mut self.line {
                        exchange.held_until.get_or_insert(now + AMBIGUITY_QUIET);
                    }
                    return;
                }
                Found::At(offset) => {
                    let Some((frame, before)) = self.receiver.take(offset, &exchange.frame) else {
                        return;
                    };
                    self.note(now, &exchange, &before);
                    if now.since(exchange.sent) < EARLIEST_REPLY {
                        // It cannot answer a request that has hardly left.
                        self.heard_late(now, &frame);
                        if let Line::Busy(exchange) = &mut self.line {
                            exchange.held_until = None;
                        }
                        continue;
                    }
                    self.line = Line::Free {
                        last: exchange.frame,
                    };
                    self.replied(now, &exchange, id, layout, &frame);
                }
            }
        }
        if let Line::Free { .. } = self.line
            && self.receiver.len() >= FRAME_LEN
        {
            self.sort_unasked_bytes(now);
        }
    }

    /// Ends the exchange in flight if its window is spent.
    pub(super) fn end_spent_window(&mut self, now: Instant) {
        let Line::Busy(exchange) = self.line else {
            return;
        };
        if now < exchange.window_ends {
            return;
        }
        self.line = Line::Free {
            last: exchange.frame,
        };
        let rest = self.receiver.clear(&exchange.frame);
        match exchange.expects {
            Expects::Nothing => self.note(now, &exchange, &rest),
            Expects::Everyone => self.id_query_ended(now, &exchange, &rest),
            Expects::Reply { id, layout } => {
                self.note(now, &exchange, &rest);
                self.round_trip.lost();
                let Some(motor) = self.motor_mut(id) else {
                    return;
                };
                motor.lost(layout, exchange.sent);
                motor.loss.count(true);
                match rest.junk_bytes {
                    0 => motor.counters.silences += 1,
                    1..FRAME_LEN => motor.counters.fragments += 1,
                    _ => motor.counters.bad_crcs += 1,
                }
            }
        }
    }

    /// Bytes that came while nobody was asked: late replies, and echoes of what is not answered.
    pub(super) fn sort_unasked_bytes(&mut self, now: Instant) {
        let Line::Free { last } = self.line else {
            return;
        };
        let rest = self.receiver.clear(&last);
        count_line(&mut self.counters, &rest);
        for frame in &rest.frames {
            self.heard_late(now, frame);
        }
    }

    fn replied(
        &mut self,
        now: Instant,
        exchange: &Exchange,
        id: MotorId,
        layout: Layout,
        frame: &Frame,
    ) {
        let took = now.since(exchange.sent);
        let Some(motor) = self.motor_mut(id) else {
            return;
        };
        motor.counters.replies += 1;
        motor.loss.count(false);
        // While a lost reply may still come, it is not known which request this one answers, so its
        // time says nothing (as in Karn's algorithm).
        let unambiguous = !motor.late_reply_may_come(now);
        if unambiguous {
            motor.round_trip.replied(took);
            motor.loop_reported();
        }
        let Ok(reply) = Reply::decode(frame, motor.layout_of_reply(now, layout)) else {
            return;
        };
        let in_the_air = motor.loop_is_in_the_air();
        match (&mut motor.control, reply.detail) {
            (Control::Switching(switch), _) => switch.heard(reply.mode),
            // A late reply may speak of the time before a switch.
            (Control::Stopping(stop), _) if exchange.sent >= stop.began() && !in_the_air => {
                stop.heard(&reply);
            }
            (Control::Driven(driven), Detail::Drive { position }) if driven.hold => {
                driven.goal = Setpoint::Position(position.into());
                driven.hold = false;
                driven.next_frame = now;
            }
            _ => {}
        }
        self.keep(now, reply);
        if unambiguous {
            self.round_trip.replied(took);
        }
    }

    /// A good frame outside its window. What was asked is not certain any more, so bytes 6 and 7
    /// stay undetermined.
    fn heard_late(&mut self, now: Instant, frame: &Frame) {
        let Ok(reply) = Reply::decode(frame, None) else {
            return;
        };
        let expected = |motor: &Motor| motor.id == reply.id && motor.late_reply_may_come(now);
        match self.motors.iter_mut().find(|motor| expected(motor)) {
            Some(motor) => {
                motor.counters.late += 1;
                self.keep(now, reply);
            }
            None => self.counters.wrong_ids += 1,
        }
    }

    fn keep(&mut self, now: Instant, reply: Reply) {
        // One that was forgotten meanwhile stays forgotten.
        let Some(motor) = self.motor_mut(reply.id) else {
            return;
        };
        if motor.heard(now, reply) {
            self.events.push_back(Event::MotorBack(reply.id));
        }
        self.events
            .push_back(Event::Telemetry(Sample { at: now, reply }));
    }

    /// Counts what stood beside a reply, or came instead of one.
    fn note(&mut self, now: Instant, exchange: &Exchange, rest: &Leftovers) {
        let counters = match exchange.expects {
            Expects::Reply { id, .. } => self.motor_mut(id).map(|motor| &mut motor.counters),
            Expects::Everyone | Expects::Nothing => None,
        };
        match counters {
            Some(counters) => count_line(counters, rest),
            None => count_line(&mut self.counters, rest),
        }
        for frame in &rest.frames {
            self.heard_late(now, frame);
        }
    }

    fn id_query_ended(&mut self, now: Instant, exchange: &Exchange, rest: &Leftovers) {
        count_line(&mut self.counters, rest);
        let outcome = match rest.frames.as_slice() {
            [] if rest.junk_bytes == 0 => {
                self.counters.silences += 1;
                IdQueryOutcome::Nobody
            }
            [frame] if rest.junk_bytes <= STRAY_BYTES_MAX => {
                self.counters.replies += 1;
                match Reply::decode(frame, Some(Layout::Drive)) {
                    Ok(reply) => IdQueryOutcome::One(reply.id),
                    Err(_) => IdQueryOutcome::Garbled,
                }
            }
            _ => {
                self.counters.bad_crcs += 1;
                IdQueryOutcome::Garbled
            }
        };
        for frame in &rest.frames {
            let Ok(reply) = Reply::decode(frame, None) else {
                continue;
            };
            let layout = self
                .watch(exchange.sent, reply.id)
                .layout_of_reply(now, Layout::Drive);
            if let Ok(reply) = Reply::decode(frame, layout) {
                self.keep(now, reply);
            }
        }
        self.events.push_back(Event::IdQueryEnded(outcome));
    }
}

fn count_line(counters: &mut Counters, rest: &Leftovers) {
    match rest.echoed {
        0 => {}
        FRAME_LEN => counters.echoes_whole += 1,
        _ => counters.echoes_cut += 1,
    }
    counters.junk_bytes += rest.junk_bytes as u64;
}
