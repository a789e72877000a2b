//! What the packet log is told.

use motorlink_protocol::{Frame, Instant, Layout};

use crate::{
    bus::Bus,
    event::Event,
    traffic::{Passed, Traffic},
};

impl Bus {
    /// Adds a line to the packet log.
    pub(crate) fn log(&mut self, at: Instant, passed: Passed) {
        self.events
            .push_back(Event::Traffic(Traffic { at, passed }));
    }

    /// Adds a good frame of a motor, with what was asked of it.
    pub(crate) fn log_heard(&mut self, at: Instant, frame: &Frame, asked: Option<Layout>) {
        let frame = *frame;
        let [speaker, ..] = *frame.bytes();
        self.doubt_proof(speaker);
        self.log(at, Passed::Heard { frame, asked });
    }
}
