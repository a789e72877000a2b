//! Events for the packet log.

use motorlink_protocol::{Frame, Instant, Layout};

use crate::{
    bus::Bus,
    event::Event,
    line_event::{JunkBytes, LineEvent, LineEventKind},
};

impl Bus {
    /// Reports an event of the line.
    pub(crate) fn log(&mut self, at: Instant, kind: LineEventKind) {
        self.events.push_back(Event::Line(LineEvent { at, kind }));
    }

    /// Reports bytes that are no good frame, unless too many came in this second.
    pub(crate) fn log_junk(&mut self, at: Instant, junk: JunkBytes) {
        if self.junk_logged.admits(at) {
            self.log(at, LineEventKind::Junk(junk));
        }
    }

    /// Reports a good frame of a motor with the layout that was asked for.
    pub(crate) fn log_received(&mut self, at: Instant, frame: &Frame, asked: Option<Layout>) {
        let frame = *frame;
        let [speaker, ..] = *frame.bytes();
        self.discard_proof_unless(speaker);
        self.log(at, LineEventKind::Received { frame, asked });
    }
}
