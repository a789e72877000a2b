//! Reactions to frames of another model or another host, and to JSON text.

use motorlink_protocol::Instant;

use super::evidence::is_drive_frame;
use crate::{
    bus::Bus,
    event::{Event, StopReason},
    receiver::{OtherBytes, Segment},
    timing::OTHER_HOST_QUIET,
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
        let expected = self.model;
        if let Some(found) = rest.other_model
            && self.evidence.other_reply(now, found)
        {
            self.events.push_back(Event::OtherModel { expected, found });
            if self.is_active(now) {
                self.stop_all(now, StopReason::OtherModel);
            }
        }
    }
}
