//! The channels of a session file, and the content of their messages.
//!
//! | topic | messages |
//! |---|---|
//! | `/wire` | frames, several in a message |
//! | `/motors/<id>/telemetry` | telemetry of a motor, derived from its replies |
//! | `/events` | events between frames |
//! | `/state` | what the page showed, for a replay |
//! | `/odom`, `/cmd_vel` | motion of a rover, derived from replies and setpoints |
//! | `/link` | counts and round trips per second, derived from frames |
//!
//! `docs/sessions.md` describes them for people who read such files.

mod channel;
pub use channel::Channel;
pub(crate) mod events;
mod json;
pub(crate) mod link;
pub(crate) mod rover;
pub(crate) mod schemas;
pub(crate) mod state;
pub(crate) mod telemetry;
pub use telemetry::TelemetryJson;
pub(crate) mod wire;

use std::collections::BTreeMap;

pub(crate) use json::{integer, push_text};

use crate::mcap::fields::Fields;

/// A topic that the reader uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Topic {
    Wire,
    Events,
    State,
}

impl Topic {
    pub(crate) const WIRE: &str = "/wire";
    pub(crate) const EVENTS: &str = "/events";
    pub(crate) const STATE: &str = "/state";
    pub(crate) const LINK: &str = "/link";
    pub(crate) const ODOM: &str = "/odom";
    pub(crate) const CMD_VEL: &str = "/cmd_vel";

    /// `None` for other topics: they are derived from these, or do not belong to a session.
    pub(crate) fn from_name(name: &str) -> Option<Self> {
        match name {
            Self::WIRE => Some(Self::Wire),
            Self::EVENTS => Some(Self::Events),
            Self::STATE => Some(Self::State),
            _ => None,
        }
    }

    /// Takes the content of a channel's record.
    pub(crate) fn read_channel(topics: &mut BTreeMap<u16, Self>, content: &[u8]) {
        if let Some((id, topic)) = Fields(content).channel_head()
            && let Some(topic) = Self::from_name(topic)
        {
            topics.insert(id, topic);
        }
    }
}
