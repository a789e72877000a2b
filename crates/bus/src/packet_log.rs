//! Events for the packet log.

use std::time::Duration;

use motorlink_protocol::{Frame, Instant, Layout};

use crate::{
    bus::Bus,
    event::Event,
    line_event::{JunkBytes, LineEvent, LineEventKind},
};

/// So many junk events are logged in a second: one for each exchange at the highest rate. A device that sends text
/// makes 1,150, and in 15 minutes they would replace all else in a log of a million.
const JUNK_LOGGED_MAX: u32 = 500;

/// The junk events of the present second.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JunkLogged {
    since: Instant,
    events: u32,
}

impl JunkLogged {
    fn admits(&mut self, at: Instant) -> bool {
        if at.since(self.since) >= Duration::from_secs(1) {
            *self = Self {
                since: at,
                events: 0,
            };
        }
        self.events = self.events.saturating_add(1);
        self.events <= JUNK_LOGGED_MAX
    }
}

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
