//! What the pages send, decoded.

use std::time::Duration;

use motorlink_bus::{Command, is_rest};
use motorlink_messages::{ToWorker, decode, runs::ToRun};
use motorlink_protocol::MotorId;
use motorlink_remote::{Stamp, ToServer};

/// The stops in a command that brings motors to rest in their loop: what is left of it for a page that may not drive, or
/// when it comes late.
pub(crate) fn stops_in(command: Command) -> Vec<Command> {
    match command {
        Command::Hold(id) => vec![Command::Stop(id)],
        Command::Drive { id, setpoint, .. } | Command::Adjust { id, setpoint, .. }
            if is_rest(setpoint) =>
        {
            vec![Command::Stop(id)]
        }
        Command::DriveGroup { setpoints, .. } | Command::AdjustGroup { setpoints, .. }
            if setpoints.entries().all(|(_, setpoint)| is_rest(setpoint)) =>
        {
            setpoints
                .entries()
                .map(|(id, _)| Command::Stop(id))
                .collect()
        }
        _ => Vec::new(),
    }
}

/// When an act was done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Act {
    pub(crate) stamp: Stamp,
    pub(crate) age: Duration,
}

/// What a page asks for.
pub(crate) enum PageRequest {
    Answer {
        challenge: u64,
    },
    Take {
        by_force: bool,
    },
    GiveUp,
    Command(Act, Command),
    Select(Act, MotorId),
    Run(Act, ToRun),
    /// It is for the page's own computer.
    ForOwnComputer,
}

impl PageRequest {
    /// Decodes a message of a page; `None` if it has broken the protocol.
    pub(crate) fn read(bytes: &[u8]) -> Option<Self> {
        let (act, message) = match decode(bytes).ok()? {
            ToServer::Answer { challenge } => return Some(Self::Answer { challenge }),
            ToServer::Take { by_force } => return Some(Self::Take { by_force }),
            ToServer::GiveUp => return Some(Self::GiveUp),
            ToServer::Act {
                stamp,
                age_ms,
                message,
            } => {
                let age = Duration::from_millis(age_ms.into());
                (Act { stamp, age }, message)
            }
        };
        Some(match decode(&message).ok()? {
            ToWorker::Command { command, .. } => Self::Command(act, command),
            ToWorker::Select(id) => Self::Select(act, id),
            ToWorker::Run { message, .. } => Self::Run(act, decode(&message).ok()?),
            ToWorker::ConnectSerial { .. }
            | ToWorker::ConnectVirtual(_)
            | ToWorker::Disconnect
            | ToWorker::Pong { .. }
            | ToWorker::VirtualWire(_) => Self::ForOwnComputer,
        })
    }
}
