//! Questions of scans and ID changes, and what they bring.

use std::time::Duration;

use motorlink_protocol::{
    MotorId,
    family::{Model, Request},
};

/// Whom a scan asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Probe {
    /// All at once, by the ID query.
    IdQuery,
    /// One address, by a feedback query.
    Query(MotorId),
    /// The same by another query, if the model has one. Behind an answer that was identical to its request.
    OtherQuery(MotorId),
}

/// What a look at one address brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ProbeResult {
    /// A good reply, after so long.
    Reply(Duration),
    /// Bytes, but no good reply.
    Noise,
    /// Nothing.
    Silence,
}

impl Probe {
    /// The request of this question.
    pub(crate) const fn request(self, model: Model) -> Request {
        match self {
            Self::IdQuery => Request::IdQuery,
            // The odometry reply of a DDSM210 at angle 0 is identical to its request, like an echo. Its loop at
            // power-up is not.
            Self::Query(id) if model.replies_look_like_requests() => Request::ModeQuery { id },
            Self::Query(id) | Self::OtherQuery(id) => Request::Query { id },
        }
    }
}
