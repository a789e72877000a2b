//! What is heard when everyone was asked at once.

use motorlink_protocol::{Instant, Layout, MotorId};

use crate::{
    bus::Bus,
    event::{Event, IdQueryOutcome},
    exchange::{Exchange, Purpose},
    motor::Motor,
    raw::frame::addressee,
    raw::status::RawAnswer,
    receiver::ReceivedReply,
    receiver::{Leftovers, Piece},
    replies::{count_line, micros},
    traffic::Passed,
};

/// Junk that may stand beside one clean reply to the ID query: less than half a frame is noise, more
/// is another motor's voice.
const STRAY_BYTES_MAX: usize = 4;

impl Bus {
    /// The window in which everyone could answer has passed.
    pub(crate) fn everyone_heard(
        &mut self,
        now: Instant,
        exchange: &Exchange,
        layout: Option<Layout>,
        rest: &Leftovers,
    ) {
        count_line(&mut self.counters, rest);
        // What only one motor may obey is answered by that one.
        let only = match exchange.purpose {
            Purpose::Raw => addressee(&exchange.frame),
            Purpose::Control | Purpose::Survey | Purpose::Pause => None,
        };
        let outcome = self.judge_answers(now, only, rest);
        let mut answer = None;
        for piece in &rest.pieces {
            let ReceivedReply { frame, reply } = match piece {
                Piece::Reply(received) => *received,
                Piece::Junk(junk) => {
                    self.log(now, Passed::Junk(*junk));
                    continue;
                }
            };
            if outcome != IdQueryOutcome::One(reply.id) {
                // Several voices may pass the CRC as one that nobody has.
                self.log_heard(now, &frame, None);
                continue;
            }
            if exchange.purpose == Purpose::Control {
                self.watch(exchange.sent, reply.id).next_query = now;
            }
            let asked = layout.and_then(|layout| match self.motor_mut(reply.id) {
                Some(motor) => motor.late.layout_of_reply(now, layout),
                None => Some(layout),
            });
            self.log_heard(now, &frame, asked);
            // A motor that is not known may have answered with it, so what was asked of all tells who
            // is there, and nothing of how it is.
            if only.is_some() {
                // Not now: the window may have ended behind a sleep.
                let at = exchange.last_byte.unwrap_or(exchange.sent);
                self.keep(at, reply.in_layout(asked));
            }
            answer = answer.or(Some((frame, asked)));
        }
        if layout.is_some() {
            // The answers of the others may still come, to one who was not known before too.
            let answered = |id: MotorId| rest.replies().any(|received| received.reply.id == id);
            let others = self.motors.iter_mut().filter(|motor| !answered(motor.id));
            for motor in others {
                motor.call_unanswered(exchange.sent);
            }
            self.called = Some(exchange.sent);
        }
        let took = exchange.last_byte.map(|last| last.since(exchange.sent));
        match exchange.purpose {
            Purpose::Control => self.events.push_back(Event::IdQueryEnded(outcome)),
            Purpose::Pause => {}
            Purpose::Survey => self.survey_called(outcome, took),
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

    /// Who answered, with the line's counters. `only` is the one motor that may, where it is one.
    fn judge_answers(
        &mut self,
        now: Instant,
        only: Option<MotorId>,
        rest: &Leftovers,
    ) -> IdQueryOutcome {
        if rest.is_silence() {
            self.counters.silences += 1;
            return IdQueryOutcome::Nobody;
        }
        let mut replies = rest.replies();
        let one = match (replies.next(), replies.next()) {
            (Some(received), None) if rest.junk_bytes <= STRAY_BYTES_MAX => Some(received.reply.id),
            _ => None,
        };
        // Where another is there, it has answered as well.
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
