//! Replies to a frame that several motors may answer.

use motorlink_protocol::{Instant, Layout, MotorId, family::Reading};

use crate::{
    bus::Bus,
    event::{Event, IdQueryOutcome},
    exchange::{Exchange, Purpose},
    motor::Motor,
    other_bytes::count_line,
    raw::frame::addressee,
    raw::status::RawAnswer,
    receiver::{OtherBytes, ReceivedReply, STRAY_BYTES_MAX, Segment},
    timing::micros,
};

impl Bus {
    /// The reply window of a broadcast has ended.
    pub(crate) fn broadcast_window_ended(
        &mut self,
        now: Instant,
        exchange: &Exchange,
        layout: Option<Layout>,
        rest: &OtherBytes,
    ) {
        count_line(&mut self.counters, rest);
        // A raw frame with one addressee is answered by that motor only.
        let only = match exchange.purpose {
            Purpose::Raw => addressee(&exchange.frame),
            Purpose::Control | Purpose::Job | Purpose::Pause => None,
        };
        let outcome = self.judge_answers(now, only, rest);
        let mut answer = None;
        for piece in &rest.segments {
            let ReceivedReply { frame, reading } = match piece {
                Segment::Reply(received) => *received,
                Segment::Junk(junk) => {
                    self.log_junk(now, *junk);
                    continue;
                }
            };
            let id = reading.id();
            if outcome != IdQueryOutcome::One(id) {
                // Several replies at once may pass the CRC as a reply of no motor.
                self.log_received(now, &frame, None);
                continue;
            }
            if exchange.purpose == Purpose::Control {
                self.watch(exchange.sent, id).next_query = now;
            }
            let asked = layout.and_then(|layout| match self.motor_mut(id) {
                Some(motor) => motor.late.layout_of_reply(now, layout),
                None => Some(layout),
            });
            self.log_received(now, &frame, asked);
            // An unknown motor may have answered too. So a broadcast tells which motors exist, not
            // their state.
            self.evidence.own_reply(id);
            if let (Some(_), Reading::Combined(reply)) = (only, reading) {
                // Not `now`: the computer may have slept before the window ended.
                let at = exchange.last_byte.unwrap_or(exchange.sent);
                self.record_reply(at, reply.in_layout(asked));
            }
            answer = answer.or(Some((frame, asked)));
        }
        self.handle_foreign_frames(now, rest);
        // The other motors, and motors added later, may still answer.
        let answered = |id: MotorId| rest.replies().any(|received| received.reading.id() == id);
        let others = self.motors.iter_mut().filter(|motor| !answered(motor.id));
        for motor in others {
            if layout.is_some() {
                motor.id_query_unanswered(exchange.sent);
            } else if only == Some(motor.id) {
                motor.unknown_frame_unanswered(exchange.sent);
            }
        }
        if layout.is_some() {
            self.last_id_query = Some(exchange.sent);
        }
        let took = exchange.last_byte.map(|last| last.since(exchange.sent));
        match exchange.purpose {
            Purpose::Control => self.events.push_back(Event::IdQueryEnded(outcome)),
            Purpose::Pause => {}
            Purpose::Job => self.job_id_query_ended(now, outcome, only_sender(rest), took),
            Purpose::Raw => self.raw_answered(match (answer, rest.is_silence()) {
                (Some((frame, asked)), _) => RawAnswer::Reply {
                    frame,
                    asked,
                    after_us: micros(took.unwrap_or_default()),
                },
                (None, true) => RawAnswer::Silence {
                    waited_us: micros(now.since(exchange.sent)),
                },
                (None, false) => RawAnswer::Garbled,
            }),
        }
    }

    /// Which motor answered; updates the counters. `only` is the single addressee, if there is one.
    fn judge_answers(
        &mut self,
        now: Instant,
        only: Option<MotorId>,
        rest: &OtherBytes,
    ) -> IdQueryOutcome {
        if rest.is_quiet() {
            self.counters.silences += 1;
            return IdQueryOutcome::NoReply;
        }
        let mut replies = rest.replies();
        let one = match (replies.next(), replies.next()) {
            // Less than half a frame is noise; more is the reply of another motor.
            (Some(received), None) if rest.junk_bytes <= STRAY_BYTES_MAX && !rest.is_block => {
                Some(received.reading.id())
            }
            _ => None,
        };
        // If another motor is present, it has answered too.
        let another =
            |id: MotorId| move |motor: &Motor| motor.id != id && motor.fresh_speed(now).is_some();
        let is_alone = |id: &MotorId| match only {
            Some(only) => only == *id,
            None => !self.motors.iter().any(another(*id)),
        };
        if let Some(id) = one.filter(is_alone) {
            self.counters.replies += 1;
            IdQueryOutcome::One(id)
        } else {
            self.counters.bad_crcs += 1;
            IdQueryOutcome::Garbled
        }
    }
}

/// The motor that sent all of these bytes, in good frames.
fn only_sender(rest: &OtherBytes) -> Option<MotorId> {
    let mut senders = rest.replies().map(|received| received.reading.id());
    let first = senders.next().filter(|_| rest.junk_bytes == 0)?;
    senders.all(|id| id == first).then_some(first)
}
