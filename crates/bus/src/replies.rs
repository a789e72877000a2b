//! Replies: matches received bytes to the exchange in flight and updates the motors.

use motorlink_protocol::{
    FRAME_LEN, Frame, Instant, Mode, MotorId, Reply,
    family::{Layout, Reading},
};

use crate::{
    bus::{Bus, LastDrive},
    event::Event,
    exchange::{Exchange, Expects, Line, Purpose},
    job::state::Job,
    line_event::JunkBytes,
    line_use::Use,
    motor::Control,
    probe::ProbeResult,
    raw::status::RawAnswer,
    receiver::{BLOCK, Found, ReceivedReply},
    reply_effect::{act_on_reply, as_reply},
    sample::Sample,
    timing::{AMBIGUITY_QUIET, LATE, MIN_WINDOW, earliest_reply, micros},
};

impl Bus {
    /// Takes bytes that the port received.
    pub fn receive(&mut self, now: Instant, bytes: &[u8]) {
        self.begin_call(now);
        self.receiver.push(bytes);
        if !bytes.is_empty() {
            self.last_drive = LastDrive::Carried;
        }
        self.counters.blocks += u64::from(bytes.len() == BLOCK);
        if let Some(Job::Scan(scan)) = &mut self.job
            && !bytes.is_empty()
        {
            scan.received(bytes.len() == BLOCK);
        }
        if let Line::Busy(exchange) = &mut self.line {
            exchange.held_until = exchange.held_until.map(|_| now + AMBIGUITY_QUIET);
            exchange.last_byte = Some(now);
        }
        self.look_for_reply(now);
        self.stop_what_is_back(now);
    }

    /// Ends the exchange in flight if its reply has arrived.
    pub(crate) fn look_for_reply(&mut self, now: Instant) {
        while let Line::Busy(exchange) = self.line
            && let Expects::Reply { id, layout } = exchange.expects
        {
            let settled = now >= exchange.deadline();
            match self.receiver.find(id, layout, &exchange.frame, settled) {
                Found::Nothing => {
                    // The bytes held back belong to another motor: keep the whole window.
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
                Found::Copy => {
                    if now.since(exchange.sent) < earliest_reply(self.model) {
                        self.receiver.echo_detected();
                    }
                    // The reply may follow, however long the line is quiet.
                    if let Line::Busy(exchange) = &mut self.line {
                        exchange.held_until = None;
                    }
                    return;
                }
                Found::At(offset) => {
                    let Some((received, before)) = self.receiver.take(offset, &exchange.frame)
                    else {
                        return;
                    };
                    self.process_other_bytes(now, &exchange, &before);
                    if before.is_block {
                        self.receive_late_reply(now, received, false);
                        continue;
                    }
                    if now.since(exchange.sent) < earliest_reply(self.model) {
                        // It arrives too early to answer this request.
                        if received.frame == exchange.frame {
                            self.receiver.echo_detected();
                        } else {
                            self.receive_late_reply(now, received, before.junk_bytes == 0);
                        }
                        if let Line::Busy(exchange) = &mut self.line {
                            exchange.held_until = None;
                        }
                        continue;
                    }
                    let motor = self.motors.iter().find(|motor| motor.id == id);
                    let outstanding = motor.is_some_and(|motor| motor.late.may_come(now));
                    if received.is_chance(before.junk_bytes, outstanding) {
                        let junk = JunkBytes::new(received.frame.bytes());
                        self.log_junk(now, junk);
                        continue;
                    }
                    let is_like_echo = self.model.has_separate_frames()
                        && begins_like(&received.frame, &exchange.frame);
                    if (is_like_echo || self.receiver.is_owed())
                        && motor.is_some_and(|motor| motor.contradicts(now, &received.reading))
                    {
                        // An echo that the adapter has delayed, or a part of one and noise.
                        if is_like_echo {
                            self.receiver.echo_detected();
                        }
                        if received.frame != exchange.frame {
                            self.log_received(now, &received.frame, None);
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
            self.process_unrequested_bytes(now);
        }
    }

    fn replied(
        &mut self,
        now: Instant,
        exchange: &Exchange,
        layout: Layout,
        received: ReceivedReply,
    ) {
        let reading = received.reading;
        let layout = layout.combined();
        let id = reading.id();
        let (asked, outstanding) = match self.motor_mut(id) {
            Some(motor) => {
                let outstanding = motor.late.may_come(now);
                let asked = match (&reading, layout) {
                    (Reading::Combined(reply), Some(layout)) => {
                        motor.layout_of(now, *reply, layout)
                    }
                    _ => None,
                };
                (asked, outstanding)
            }
            None => (layout, false),
        };
        self.reply_taken(now, exchange, received, asked, outstanding);
    }

    /// The reply to a request, read in the layout `asked`. `outstanding` if a reply to an earlier request may still come.
    pub(crate) fn reply_taken(
        &mut self,
        now: Instant,
        exchange: &Exchange,
        received: ReceivedReply,
        asked: Option<motorlink_protocol::Layout>,
        outstanding: bool,
    ) {
        let ReceivedReply { frame, reading } = received;
        let model = self.model;
        let id = reading.id();
        self.evidence.own_reply(id);
        let took = exchange.took(now);
        self.log_received(now, &frame, asked);
        let own_reply = exchange.sent + self.round_trip.usual().min(MIN_WINDOW);
        if outstanding && own_reply > now {
            // It may answer an earlier request while the reply to this one is still on the wire.
            self.line = Line::Busy(Exchange::pause(now, exchange.frame, own_reply));
        }
        match exchange.purpose {
            Purpose::Control | Purpose::Pause => {}
            Purpose::Job => self.job_probe_ended(now, exchange.sent, id, ProbeResult::Reply(took)),
            Purpose::Raw => self.raw_answered(RawAnswer::Reply {
                frame,
                asked,
                after_us: micros(took),
            }),
        }
        let Some(motor) = self.motors.iter_mut().find(|motor| motor.id == id) else {
            // A motor that is not watched has no state to update.
            self.counters.replies += 1;
            return;
        };
        motor.counters.replies += 1;
        motor.loss.count(false);
        if motor.late.id_query_is_recent(now) {
            // Several replies at once may pass the CRC as a reply of no motor.
            motor.count_reply();
            return;
        }
        if exchange.purpose == Purpose::Control && self.receiver.wants_proof() {
            motor.separate.asks_loop = matches!(reading, Reading::Mode(_));
            motor.next_query = now;
        }
        let confirms_loop = motor.confirms_loop();
        let names_loop = reading.names_loop(model);
        if names_loop.is_some() {
            motor.loop_reported();
        }
        let measures_round_trip = !motor.late.makes_round_trip_ambiguous(now);
        if measures_round_trip {
            motor.round_trip.replied(took);
            if motor
                .round_trip
                .fastest()
                .is_some_and(|fastest| took > fastest + LATE)
            {
                self.late.count(now);
            }
            // A late reply may report the time before this frame.
            if motor.late.outstanding(now) == 0 {
                motor.torque.answered(&exchange.frame);
                if let Control::Stopping(stop) = &mut motor.control
                    && stop.last_sent() == Some(exchange.sent)
                {
                    stop.answered();
                }
            }
        }
        let unconfirmed = motor.loop_is_unconfirmed();
        let waited = motor.must_name_loop(now);
        // The reply may answer an earlier request of the same kind, if that is not long ago.
        let measured = measures_round_trip.then_some(exchange.sent);
        let Some(reply) = as_reply(motor, now, measured, &reading, asked) else {
            if !matches!(reading, Reading::Mode(_)) && motor.tells(now) {
                self.events.push_back(Event::MotorBack(id));
            }
            self.loop_named(now, id, names_loop.filter(|_| confirms_loop), waited);
            if measures_round_trip {
                self.round_trip.replied(took);
            }
            return;
        };
        let names_loop = confirms_loop && names_loop.is_some();
        if let Control::Driven(driven) = &mut motor.control
            && waited
            && driven.goal.mode() != Mode::Velocity
            && !model.has_separate_frames()
        {
            driven.next_frame = now;
        }
        act_on_reply(motor, now, exchange.sent, &reply, names_loop, unconfirmed);
        self.record_reply(now, reply);
        if !model.has_separate_frames() {
            self.end_raw_wait(now, id, waited);
        }
        if measures_round_trip {
            self.round_trip.replied(took);
        }
    }

    /// A motor has answered. If the raw frame `waited` for that, it goes out now.
    fn end_raw_wait(&mut self, now: Instant, id: MotorId, waited: bool) {
        if let Some(raw) = self.raw.as_mut().filter(|raw| waited && raw.may_move(id)) {
            raw.end_wait(now);
        }
    }

    /// A reply has named the loop and nothing else, or has not named it.
    /// `waited` if a drive frame waited for it.
    fn loop_named(&mut self, now: Instant, id: MotorId, named: Option<Mode>, waited: bool) {
        self.end_raw_wait(now, id, waited);
        let Some(motor) = self.motor_mut(id) else {
            return;
        };
        motor.request_answered(now);
        motor.count_reply();
        match (&mut motor.control, named) {
            (Control::Switching(switch), Some(mode)) => switch.record_mode(mode),
            (Control::Stopping(stop), Some(mode)) => stop.record_loop(mode),
            // Before all other drive frames: behind those of several motors on a slow adapter, the answer would be too
            // old for it again.
            (Control::Driven(driven), Some(_)) if waited => driven.next_frame = Instant::ZERO,
            _ => {}
        }
    }

    /// Records a late reply for the stop of its motor, if it can only answer a request of this stop. `oldest` is when
    /// the oldest request was sent that it may answer.
    ///
    /// A stop of several motors does not wait for replies that an adapter holds.
    pub(crate) fn stop_takes_late_reply(
        &mut self,
        now: Instant,
        oldest: Option<Instant>,
        reading: &Reading,
    ) -> bool {
        let id = reading.id();
        let Some(motor) = self.motors.iter_mut().find(|motor| motor.id == id) else {
            return false;
        };
        let Control::Stopping(stop) = motor.control else {
            return false;
        };
        let is_of_stop = oldest.is_some_and(|sent| sent >= stop.began());
        if !is_of_stop || motor.late.may_answer_id_query() || motor.loop_is_unconfirmed() {
            return false;
        }
        let Some(reply) = as_reply(motor, now, None, reading, None) else {
            let named = reading.names_loop(motor.model);
            self.loop_named(now, id, named, false);
            return true;
        };
        let named = !motor.model.has_separate_frames() || motor.last_mode().is_some();
        // The layout is likely, not certain: it serves to compare angles, not as telemetry.
        let likely = oldest.and_then(|sent| stop.layout_since(sent));
        let angle_stands = if motor.model.has_separate_frames() {
            motor.standstill.record(now, &reply)
        } else {
            motor.standstill.record(now, &reply.in_layout(likely))
        };
        if let Control::Stopping(stop) = &mut motor.control
            && named
        {
            stop.record_reply(&reply, angle_stands);
        }
        self.record_reply(now, reply);
        true
    }

    pub(crate) fn record_reply(&mut self, now: Instant, reply: Reply) {
        // A motor that was forgotten meanwhile stays forgotten.
        let limits = self.settings.limits;
        let Some(motor) = self.motor_mut(reply.id) else {
            return;
        };
        if motor.record_reply(now, reply, limits) {
            self.events.push_back(Event::MotorBack(reply.id));
        }
        self.events
            .push_back(Event::Telemetry(Sample { at: now, reply }));
    }
}

/// Whether a reply differs from its request in the last three bytes at most, behind the acceleration.
fn begins_like(reply: &Frame, request: &Frame) -> bool {
    reply.bytes().get(..7) == request.bytes().get(..7)
}
