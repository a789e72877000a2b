//! The bus on an open line, without a thread and without a clock.

use motorlink_bus::{Bus, BusSettings, Event, Output};
use motorlink_messages::LeftBehind;
use motorlink_protocol::Instant;

use crate::{
    driven_file::DrivenFile,
    entry::Entry,
    line::{Line, Written},
    runs::Runs,
};

/// An open line with its bus.
pub(crate) struct Host {
    pub(crate) bus: Bus,
    pub(crate) line: Box<dyn Line>,
    /// Whether the ID query of the opened line has ended, or there is none.
    pub(crate) has_queried: bool,
}

/// What follows from a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turned {
    /// The next turn is due at this moment, or earlier when bytes or a command arrive.
    Wait(Instant),
    /// The port is gone.
    Gone,
}

impl Host {
    /// Bytes have arrived.
    pub(crate) fn receive(&mut self, now: Instant, bytes: &[u8]) {
        self.line.has_received();
        self.bus.receive(now, bytes);
    }

    /// Does everything that is due.
    pub(crate) fn turn(
        &mut self,
        now: Instant,
        file: &mut DrivenFile,
        (runs, settings): (&mut Runs, BusSettings),
        mut tell: impl FnMut(Entry),
    ) -> Turned {
        #[cfg(test)]
        assert!(!runs.program.fails, "asked for by a test");
        runs.tick(now, &mut self.bus, settings);
        loop {
            let received = || self.line.take_received(now);
            let output = runs.poll(now, &mut self.bus, settings, received);
            // Before the frame: a process that is killed behind it leaves a file that names the motor.
            if !file.remember(self.bus.model(), || self.bus.left_driven()) {
                tell(Entry::NotRemembered);
            }
            match output {
                Output::Transmit(frame) => match self.line.write(now, self.bus.model(), &frame) {
                    Written::Taken => runs.frame_taken(now),
                    Written::Refused => self.bus.transmit_failed(),
                    Written::Gone => {
                        self.bus.transmit_failed();
                        return Turned::Gone;
                    }
                },
                Output::Event(event) => {
                    self.has_queried |= matches!(event, Event::IdQueryEnded(_));
                    tell(Entry::Event(event));
                }
                Output::Wait(at) => {
                    let others = [self.line.next_event(), runs.wake()];
                    let next = others.into_iter().flatten().fold(at, Instant::min);
                    return Turned::Wait(next);
                }
            }
        }
    }

    /// Ends the bus. Returns its last events, and what it leaves driven.
    pub(crate) fn close(mut self, now: Instant) -> (Vec<Event>, LeftBehind) {
        let last = self.bus.close(now).collect();
        let left = LeftBehind {
            model: self.bus.model(),
            motors: self.bus.left_driven().collect(),
        };
        (last, left)
    }
}
