//! The channels whose messages are JSON.

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
    pub fn topic(self) -> String {
        let topic = match self {
            Self::Wire => Topic::WIRE,
            Self::Events => Topic::EVENTS,
            Self::Link => Topic::LINK,
            Self::Telemetry(id) => return format!("/motors/{}/telemetry", id.get()),
            Self::Odometry => Topic::ODOM,
            Self::CommandedMotion => Topic::CMD_VEL,
        };
        topic.to_owned()
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
