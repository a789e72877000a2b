//! Events for the packet log.

use motorlink_protocol::{Frame, Instant, Layout};

use crate::{
    bus::Bus,
    event::Event,
    line_event::{LineEvent, LineEventKind},
};

impl Bus {
    /// Reports an event of the line.
    pub(crate) fn log(&mut self, at: Instant, kind: LineEventKind) {
        self.events.push_back(Event::Line(LineEvent { at, kind }));
    }

    /// Reports a good frame of a motor with the layout that was asked for.
    pub(crate) fn log_received(&mut self, at: Instant, frame: &Frame, asked: Option<Layout>) {
        let frame = *frame;
        let [speaker, ..] = *frame.bytes();
        self.discard_proof_unless(speaker);
        self.log(at, LineEventKind::Received { frame, asked });
    }
}
