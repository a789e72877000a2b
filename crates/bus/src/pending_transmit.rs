//! A frame that was handed out and that the port has not yet taken.

use motorlink_protocol::{Frame, Instant, Mode, MotorId};

use crate::{
    exchange::{Expects, Purpose},
    motor::Control,
    next_request::Sent,
    schedule::Errand,
};

/// A frame that was handed out, until the port has taken it or not.
///
/// All of its effects wait for that: a frame that the port did not take was not sent, and has none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HandedOut {
    pub(crate) at: Instant,
    pub(crate) frame: Frame,
    pub(crate) expects: Expects,
    pub(crate) purpose: Purpose,
    /// The loop in which its motor reads a drive frame, for the log.
    pub(crate) mode: Option<Mode>,
    pub(crate) effect: Effect,
}

/// What a frame changes once it was taken.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Effect {
    IdQuery,
    /// The scan or the ID change has counted it already: where it was not taken it is sent again.
    Survey(Errand),
    Raw,
    Motor {
        id: MotorId,
        control: Control,
        sent: Sent,
    },
}
