//! Reactions to frames of another model or another host, and to text.

use motorlink_protocol::Instant;

use super::{evidence::is_drive_frame, foreign_text::TEXT_GONE};
use crate::{
    bus::Bus,
    event::{Event, StopReason},
    motor::Motor,
    receiver::{OtherBytes, Segment},
    timing::{OTHER_HOST_QUIET, QUERY_PERIOD},
};

/// A motor gets so many requests before a device that sends text is left alone: it may write a log while it starts.
const ASKED_MIN: u64 = 5;

impl Bus {
    /// Handles the frames of another model or another host among these bytes, and text.
    pub(crate) fn handle_foreign_frames(&mut self, now: Instant, rest: &OtherBytes) {
        if rest.junk_bytes > 0
            && let Some(is_json) = self.text.heard(now, rest.text)
        {
            self.events.push_back(Event::SendsText { is_json });
        }
        if rest.text.is_some() && self.text.is_heard(now) {
            self.leave_alone(now + TEXT_GONE);
        }
        let drives = |piece: &Segment| match piece {
            Segment::Junk(junk) => is_drive_frame(junk.bytes()),
            Segment::Reply(_) => false,
        };
        if let Some(from) = &mut self.enables_from
            && rest.segments.iter().any(drives)
        {
            *from = (*from).max(now + OTHER_HOST_QUIET);
        }
        let Some((id, found)) = rest.other_model else {
            return;
        };
        if self.evidence.other_reply(now, id, found) {
            let expected = self.model;
            self.events.push_back(Event::OtherModel { expected, found });
            // Even if none is driven: the operator's release ends it.
            self.stop_all(now, StopReason::OtherModel);
        } else if self.evidence.other.is_none() {
            self.ask_suspects(now + QUERY_PERIOD);
        }
    }

    /// A device sends text. A motor that was asked a few times and has never answered is not asked into that.
    fn leave_alone(&mut self, until: Instant) {
        let was_asked = |motor: &&mut Motor| motor.counters.requests >= ASKED_MIN;
        for motor in self.motors.iter_mut().filter(was_asked) {
            if !motor.has_answered() {
                motor.next_query = motor.next_query.max(until);
            }
        }
    }

    /// Whether a device that is no motor sends text on this port.
    #[must_use]
    pub fn hears_text(&self, now: Instant) -> bool {
        self.text.is_heard(now)
    }

    /// The operator releases the motors. If a motor of another model still answers, that shows at once.
    pub(crate) fn release(&mut self, now: Instant) {
        self.halted = false;
        self.evidence.release(now);
        self.ask_suspects(now);
    }

    /// Asks the motors that seem to be of another model soon. They are silent, so they are asked rarely.
    fn ask_suspects(&mut self, at: Instant) {
        for motor in &mut self.motors {
            if self.evidence.suspects(motor.id) {
                motor.next_query = motor.next_query.min(at);
                // A DDSM115 answers no query of the loop.
                motor.separate.asks_loop = false;
            }
        }
    }
}
