//! The channels whose messages are JSON.

use std::borrow::Cow;

use motorlink_protocol::MotorId;

use super::{
    Topic,
    schemas::{self, Schema},
};

/// A channel with JSON messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Frames, several in a message.
    Wire,
    /// Events between frames.
    Events,
    /// Counts and round trips per second.
    Link,
    /// Replies of a motor.
    Telemetry(MotorId),
    /// Motion of a rover.
    Odometry,
    /// Commanded motion of a rover.
    CommandedMotion,
}

impl Channel {
    /// Its name.
    #[must_use]
    pub fn topic(self) -> Cow<'static, str> {
        match self {
            Self::Wire => Topic::WIRE.into(),
            Self::Events => Topic::EVENTS.into(),
            Self::Link => Topic::LINK.into(),
            Self::Telemetry(id) => format!("/motors/{}/telemetry", id.get()).into(),
            Self::Odometry => Topic::ODOM.into(),
            Self::CommandedMotion => Topic::CMD_VEL.into(),
        }
    }

    /// The name of the schema of its messages, and the schema (`jsonschema`).
    #[must_use]
    pub const fn schema(self) -> Schema {
        match self {
            Self::Wire => schemas::WIRE,
            Self::Events => schemas::EVENT,
            Self::Link => schemas::LINK,
            Self::Telemetry(_) => schemas::TELEMETRY,
            Self::Odometry => schemas::ODOMETRY,
            Self::CommandedMotion => schemas::TWIST,
        }
    }
}
