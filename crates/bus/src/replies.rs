//! What is heard.

use std::time::Duration;

use motorlink_protocol::{FRAME_LEN, Instant, Layout, MotorId, Reply, Setpoint};

use crate::{
    bus::{Bus, LastDrive},
    counters::Counters,
    event::Event,
    exchange::{Exchange, Expects, Line, Purpose},
    job::state::Survey,
    line_use::Use,
    motor::{Control, Motor},
    probe::Look,
    raw::status::RawAnswer,
    receiver::ReceivedReply,
    receiver::{Found, Leftovers, Piece},
    sample::Sample,
    timing::{AMBIGUITY_QUIET, DRIVEN_UNANSWERED_MAX, EARLIEST_REPLY, MIN_WINDOW},
    traffic::Passed,
};

impl Bus {
    /// Takes bytes that the port delivered.
    pub fn receive(&mut self, now: Instant, bytes: &[u8]) {
        self.begin_call(now);
        self.receiver.push(bytes);
        if !bytes.is_empty() {
            self.last_drive = LastDrive::Carried;
        }
        if let Line::Busy(exchange) = &mut self.line {
            exchange.held_until = exchange.held_until.map(|_| now + AMBIGUITY_QUIET);
            exchange.last_byte = Some(now);
        }
        self.look_for_reply(now);
    }

    /// Ends the exchange in flight if its reply is there.
    pub(crate) fn look_for_reply(&mut self, now: Instant) {
        while let Line::Busy(exchange) = self.line
            && let Expects::Reply { id, layout } = exchange.expects
        {
            let settled = now >= exchange.deadline();
            match self.receiver.find(id, &exchange.frame, settled) {
                Found::Nothing => {
                    // What was held back is another motor's: nothing is waited for sooner.
                    if let Line::Busy(exchange) = &mut self.line {
                        exchange.held_until = None;
                    }
                    return;
                }
                Found::Ambiguous => {
                    if let Line::Busy(exchange) = &mut self.line {
                        exchange.held_until.get_or_insert(now + AMBIGUITY_QUIET);
                    }
                    return;
                }
                Found::At(offset) => {
                    let Some((received, before)) = self.receiver.take(offset, &exchange.frame)
                    else {
                        return;
                    };
                    self.note(now, &exchange, &before);
                    if now.since(exchange.sent) < EARLIEST_REPLY {
                        // It cannot answer a request that has hardly left.
                        self.heard_late(now, received);
                        if let Line::Busy(exchange) = &mut self.line {
                            exchange.held_until = None;
                        }
                        continue;
                    }
                    self.line = Line::Free {
                        last: exchange.frame,
                    };
                    let took = now.since(exchange.sent);
                    self.line_use.add(now, Use::of(&exchange.frame), took);
                    self.freed_at = now;
                    self.replied(now, &exchange, layout, received);
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
            // Its echo may still be coming in pieces: it is sorted before the next frame is sent.
            if exchange.purpose == Purpose::Raw {
                self.raw_answered(RawAnswer::NoneExpected);
            }
            return;
        }
        let rest = self.receiver.clear(&exchange.frame);
        match exchange.expects {
            Expects::Nothing => {}
            Expects::Everyone { layout } => self.everyone_heard(now, &exchange, layout, &rest),
            Expects::Reply { id, layout } => {
                self.note(now, &exchange, &rest);
                self.unanswered(now, &exchange, id, layout, &rest);
            }
        }
    }

    /// The window of a motor that was asked has passed without its reply.
    fn unanswered(
        &mut self,
        now: Instant,
        exchange: &Exchange,
        id: MotorId,
        layout: Layout,
        rest: &Leftovers,
    ) {
        let waited_us = micros(now.since(exchange.sent));
        match exchange.purpose {
            // That a motor is silent that was silent before says nothing of the adapter, unless all are.
            Purpose::Control if self.tells_of_the_adapter(now, id) => self.round_trip.lost(),
            Purpose::Control | Purpose::Pause => {}
            Purpose::Survey if rest.is_silence() => {
                self.survey_looked(now, exchange.sent, id, Look::Silence);
            }
            Purpose::Survey => self.survey_looked(now, exchange.sent, id, Look::Noise),
            Purpose::Raw if rest.is_silence() => {
                self.raw_answered(RawAnswer::Silence { waited_us });
            }
            Purpose::Raw => self.raw_answered(RawAnswer::Garbled),
        }
        // A scan expects most addresses to be silent.
        if rest.is_silence() && !matches!(self.survey, Some(Survey::Scan(_))) {
            self.log(now, Passed::Silence { id, waited_us });
        }
        let counters = match self.motors.iter_mut().find(|motor| motor.id == id) {
            Some(motor) => {
                motor.lost(layout, exchange.sent);
                motor.loss.count(true);
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
            // It stood for the drive frames that wait for a proof: their motors are as silent.
            for motor in self.motors.iter_mut().filter(|motor| motor.id != id) {
                if let Control::Driven(_) = motor.control {
                    motor.unanswered_in_a_row = motor.unanswered_in_a_row.saturating_add(1);
                }
            }
        }
    }

    /// Whether a lost reply of this motor may mean that the adapter has grown slower.
    fn tells_of_the_adapter(&self, now: Instant, id: MotorId) -> bool {
        let was_silent = |motor: &Motor| motor.unanswered_in_a_row >= DRIVEN_UNANSWERED_MAX;
        let motor = self.motors.iter().find(|motor| motor.id == id);
        let other_answers = |motor: &Motor| motor.id != id && motor.fresh_speed(now).is_some();
        !motor.is_some_and(was_silent) || !self.motors.iter().any(other_answers)
    }

    /// Bytes that came while nobody was asked: late replies, and echoes of what is not answered.
    pub(crate) fn sort_unasked_bytes(&mut self, now: Instant) {
        let Line::Free { last } = self.line else {
            return;
        };
        let rest = self.receiver.clear(&last);
        count_line(&mut self.counters, &rest);
        self.pass_on(now, &rest);
    }

    fn replied(
        &mut self,
        now: Instant,
        exchange: &Exchange,
        layout: Layout,
        received: ReceivedReply,
    ) {
        let ReceivedReply { frame, reply } = received;
        let id = reply.id;
        let took = now.since(exchange.sent);
        let (asked, owed) = match self.motor_mut(id) {
            Some(motor) => {
                let owed = motor.late.may_come(now);
                (motor.layout_of(now, reply, layout), owed)
            }
            None => (Some(layout), false),
        };
        let reply = reply.in_layout(asked);
        self.log_heard(now, &frame, asked);
        let own_reply = exchange.sent + self.round_trip.usual().min(MIN_WINDOW);
        if owed && own_reply > now {
            // This may be the reply to an earlier request, and the own one still be on the wire.
            self.line = Line::Busy(Exchange::pause(now, exchange.frame, own_reply));
        }
        match exchange.purpose {
            Purpose::Control | Purpose::Pause => {}
            Purpose::Survey => self.survey_looked(now, exchange.sent, id, Look::Reply(took)),
            Purpose::Raw => self.raw_answered(RawAnswer::Reply {
                frame,
                asked,
                after_us: micros(took),
            }),
        }
        let Some(motor) = self.motors.iter_mut().find(|motor| motor.id == id) else {
            // One that is not watched is only told of.
            self.counters.replies += 1;
            return;
        };
        motor.counters.replies += 1;
        motor.loss.count(false);
        let tells_round_trip = !motor.late.blurs_round_trips(now);
        if tells_round_trip {
            motor.round_trip.replied(took);
            // A late reply may speak of the time before a switch, or of the frame before.
            motor.loop_reported();
            motor.torque.answered(&exchange.frame);
        }
        let in_the_air = motor.loop_is_in_the_air();
        motor.reckoning.replied(now, &reply);
        let seen = motor.reckoning.just_seen(now);
        match (&mut motor.control, reply.detail) {
            (Control::Switching(switch), _) => switch.heard(reply.mode),
            // A late reply may speak of the time before a switch.
            (Control::Stopping(stop), _) if exchange.sent >= stop.began() && !in_the_air => {
                stop.heard(&reply);
            }
            (Control::Stopping(stop), _) => stop.heard_uncertain(reply.mode),
            (Control::Driven(driven), _) => {
                // A reply soon after Hold may say where the wheel was then.
                if let Some(hold) = driven.hold
                    && let Some(held) = hold.refined(now, seen, reply.speed)
                {
                    driven.goal = Setpoint::Position(held);
                    driven.next_frame = now;
                    driven.hold = None;
                }
            }
            _ => {}
        }
        self.keep(now, reply);
        if tells_round_trip {
            self.round_trip.replied(took);
        }
    }

    /// A good frame outside its window. What was asked is not certain any more, so bytes 6 and 7
    /// stay undetermined.
    fn heard_late(&mut self, now: Instant, received: ReceivedReply) {
        let ReceivedReply { frame, reply } = received;
        self.log_heard(now, &frame, None);
        self.late_heard = Some(now);
        self.survey_heard_late(now, reply.id);
        let expected = |motor: &Motor| motor.id == reply.id && motor.late.may_come(now);
        match self.motors.iter_mut().find(|motor| expected(motor)) {
            Some(motor) => {
                motor.counters.late += 1;
                if motor.late.blurs_round_trips(now) {
                    self.keep(now, reply);
                } else {
                    // Nobody knows how old it is: it pays a debt and is no reading of now.
                    motor.late.replied();
                }
            }
            None => self.counters.wrong_ids += 1,
        }
    }

    pub(crate) fn keep(&mut self, now: Instant, reply: Reply) {
        // One that was forgotten meanwhile stays forgotten.
        let limits = self.limits;
        let round = self.stop_round();
        let Some(motor) = self.motor_mut(reply.id) else {
            return;
        };
        if motor.is_without_answer()
            && let (Control::Stopping(stop), Some(round)) = (&mut motor.control, round)
        {
            // It joins those that answer: they keep their brake meanwhile.
            stop.round = stop.round.max(round);
        }
        if motor.heard(now, reply, limits) {
            self.events.push_back(Event::MotorBack(reply.id));
        }
        self.events
            .push_back(Event::Telemetry(Sample { at: now, reply }));
    }

    /// Counts what stood beside a reply, or came instead of one.
    fn note(&mut self, now: Instant, exchange: &Exchange, rest: &Leftovers) {
        let counters = match exchange.expects {
            Expects::Reply { id, .. } => self.motor_mut(id).map(|motor| &mut motor.counters),
            Expects::Everyone { .. } | Expects::Nothing => None,
        };
        match counters {
            Some(counters) => count_line(counters, rest),
            None => count_line(&mut self.counters, rest),
        }
        self.pass_on(now, rest);
    }

    /// Logs what came beside the reply that was waited for, and keeps what is good of it.
    fn pass_on(&mut self, now: Instant, rest: &Leftovers) {
        for piece in &rest.pieces {
            match piece {
                Piece::Reply(received) => self.heard_late(now, *received),
                Piece::Junk(junk) => self.log(now, Passed::Junk(*junk)),
            }
        }
    }
}

pub(crate) fn micros(duration: Duration) -> u32 {
    u32::try_from(duration.as_micros()).unwrap_or(u32::MAX)
}

pub(crate) fn count_line(counters: &mut Counters, rest: &Leftovers) {
    match rest.echoed {
        0 => {}
        FRAME_LEN => counters.echoes_whole += 1,
        _ => counters.echoes_cut += 1,
    }
    counters.junk_bytes += rest.junk_bytes as u64;
}
