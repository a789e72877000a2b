//! Reactions to frames of another model or another host, and to JSON text.

use motorlink_protocol::Instant;

use super::evidence::is_drive_frame;
use crate::{
    bus::Bus,
    event::{Event, StopReason},
    receiver::{OtherBytes, Segment},
    timing::{OTHER_HOST_QUIET, QUERY_PERIOD},
};

impl Bus {
    /// Handles the frames of another model or another host among these bytes, and JSON text.
    pub(crate) fn handle_foreign_frames(&mut self, now: Instant, rest: &OtherBytes) {
        if rest.is_json && self.evidence.json(now) {
            self.events.push_back(Event::AnswersInJson);
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
