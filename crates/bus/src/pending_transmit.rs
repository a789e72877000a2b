//! A frame that the caller transmits and the port has not yet confirmed.

use motorlink_protocol::{Frame, Instant, Mode, MotorId};

use crate::{
    exchange::{Expects, Purpose},
    motor::Control,
    next_request::Sent,
    schedule::DueFrame,
};

/// A frame that was given to the caller, until the port takes or refuses it.
///
/// Its effects wait for that: a refused frame was not sent and has none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PendingTransmit {
    pub(crate) at: Instant,
    pub(crate) frame: Frame,
    pub(crate) expects: Expects,
    pub(crate) purpose: Purpose,
    /// The loop in which the motor reads a drive frame, for the packet log.
    pub(crate) mode: Option<Mode>,
    pub(crate) effect: Effect,
}

/// What a frame changes once the port has taken it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Effect {
    IdQuery,
    /// The scan or ID change has counted it already. A refused frame is sent again.
    Job(DueFrame),
    Raw,
    Motor {
        id: MotorId,
        control: Control,
        sent: Sent,
    },
}
