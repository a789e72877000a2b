//! A start: a setpoint, and what the operator has confirmed for it.

use motorlink_protocol::Setpoint;

use crate::command::Consent;

/// A start of a motor in any loop. It may wait for a stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start {
    pub(crate) setpoint: Setpoint,
    pub(crate) consent: Consent,
}
