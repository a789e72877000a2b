//! What the caller does, and what it says of the ports.

use motorlink_protocol::family::Model;

#[cfg(doc)]
use crate::Opening;

/// What the caller does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Claim this port, so that no other program opens it. If that fails, call [`Opening::refused`].
    Claim(usize),
    /// Open this port for this model, and call [`Opening::opened`] before anything is sent. If it does not open, call
    /// [`Opening::refused`].
    Open(usize, Model),
    /// Close the open port.
    Close,
    /// Run the open port for [`Opening::STEP`].
    Wait,
    /// The open port is the right one: its trial is over.
    Done,
    /// No port is open.
    Failed,
}

/// The ports of one make, besides the open one, that may have motors that were left driven on ports of this make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Others {
    /// How many there are.
    pub count: usize,
    /// How many of them are tried, too.
    pub tried: usize,
}

impl Others {
    /// There are none.
    pub const NONE: Self = Self { count: 0, tried: 0 };
}

/// What happens if the wanted motor replies on none of the ports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IfNoReply {
    /// The first that opens is taken: a person chose it or plugged it in.
    TakeFirst,
    /// None is taken: another adapter of the same make is not the one that was lost.
    KeepWaiting,
}
