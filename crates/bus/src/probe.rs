//! Questions of scans and ID changes, and what they bring.

use std::time::Duration;

use motorlink_protocol::{MotorId, Request};

/// Whom a scan asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ask {
    /// All at once, by the ID query.
    Everyone,
    /// One address, by a feedback query.
    One(MotorId),
}

/// What a look at one address brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Look {
    /// A good reply, after so long.
    Reply(Duration),
    /// Bytes, but no good reply.
    Noise,
    /// Nothing.
    Silence,
}

impl Ask {
    /// The request of this question.
    pub(crate) const fn request(self) -> Request {
        match self {
            Self::Everyone => Request::IdQuery,
            Self::One(id) => Request::Query { id },
        }
    }
}
