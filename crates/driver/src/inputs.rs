//! What goes to the thread that owns the port, and what it tells the program.

use std::sync::mpsc::SyncSender;

use motorlink_bus::Command;
use motorlink_messages::runs::ToRun;
use motorlink_protocol::Instant;

use crate::entry::{Entry, Status};

/// What wakes the thread.
pub(crate) enum Input {
    /// Bytes of the port with this number.
    Bytes(u32, Vec<u8>),
    /// The port with this number is gone.
    PortGone(u32),
    /// A command, and when it was given.
    Command(Command, std::time::Instant),
    /// A message to the run of an experiment, and when it was given.
    Run(Box<ToRun>, std::time::Instant),
    /// The program takes entries.
    Alive,
    /// The program asks for the state.
    Status(SyncSender<Status>),
    /// Stop the motors, close the port and end.
    End,
    /// Fail in the next turn, for tests.
    #[cfg(test)]
    Fail,
    /// Let the program of the runs fail at every call, for tests.
    #[cfg(test)]
    FailRuns,
}

/// What goes to the program.
pub(crate) enum Told {
    Entry(Instant, Entry),
    /// The program answers by [`Input::Alive`].
    Ping,
}
