//! What goes to the thread that owns the port, and what it tells the program.

use std::{sync::mpsc::SyncSender, time::Instant as SystemInstant};

use motorlink_bus::Command;
use motorlink_messages::runs::ToRun;
use motorlink_protocol::Instant;

use crate::entry::{Entry, Status};

/// An input, and when it was given.
pub(crate) struct Given {
    pub(crate) at: SystemInstant,
    pub(crate) input: Input,
}

impl From<Input> for Given {
    /// It is given now.
    fn from(input: Input) -> Self {
        let at = SystemInstant::now();
        Self { at, input }
    }
}

/// What wakes the thread.
#[derive(Debug)]
pub enum Input {
    /// Bytes of the port with this number.
    Bytes(u32, Vec<u8>),
    /// The port with this number is gone.
    PortGone(u32),
    /// A command.
    Command(Command),
    /// A message to the run of an experiment.
    Run(Box<ToRun>),
    /// The program takes entries.
    Alive,
    /// The program asks for the state.
    Status(SyncSender<Status>),
    /// Stop the motors, close the port and end.
    End,
    /// Fail in the next turn, for tests.
    #[cfg(test)]
    Fail,
    /// Fail in every turn as long as the runs are these, for tests.
    #[cfg(test)]
    FailRuns,
}

/// What goes to the program.
#[derive(Debug)]
pub enum Told {
    /// Something happened at this moment.
    Entry(Instant, Entry),
    /// The program answers by [`Input::Alive`].
    Ping,
}
