//! What the packet log is told.

use motorlink_protocol::{Frame, Instant, Layout};

use super::Bus;
use crate::{Event, Passed, Traffic};

impl Bus {
    /// Adds a line to the packet log.
    pub(super) fn log(&mut self, at: Instant, passed: Passed) {
        self.events
            .push_back(Event::Traffic(Traffic { at, passed }));
    }

    /// The line did not take the frame that was handed out last; to be called before the next poll.
    ///
    /// The log has it as not sent. Nothing else is different from a frame that got lost: it is waited for,
    /// its motor counts as silent, and a line that takes nothing ends in withdrawn setpoints.
    pub fn unsent(&mut self) {
        if let Some(Event::Traffic(Traffic { passed, .. })) = self.events.back_mut()
            && let Passed::Sent { frame, .. } = *passed
        {
            *passed = Passed::Unsent { frame };
        }
    }

    /// Adds a good frame of a motor, with what was asked of it.
    pub(super) fn log_heard(&mut self, at: Instant, frame: &Frame, asked: Option<Layout>) {
        let frame = *frame;
        let [speaker, ..] = *frame.bytes();
        self.doubt_proof(speaker);
        self.log(at, Passed::Heard { frame, asked });
    }
}
