//! The channels of a session file: what a message of each holds.
//!
//! | topic | messages |
//! |---|---|
//! | `/wire` | frames, several in a message |
//! | `/motors/<id>/telemetry` | what a motor reported, derived from its replies |
//! | `/events` | what happened between frames |
//! | `/link` | counts and round trips of a second, derived from frames |
//!
//! `docs/sessions.md` describes them for people who read such files.

pub(crate) mod events;
mod json;
pub(crate) mod link;
pub(crate) mod schemas;
pub(crate) mod telemetry;
pub(crate) mod wire;

pub(crate) use json::{integer, push_text};

/// A topic that a reader reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Topic {
    Wire,
    Events,
}

impl Topic {
    pub(crate) const WIRE: &str = "/wire";
    pub(crate) const EVENTS: &str = "/events";
    pub(crate) const LINK: &str = "/link";

    /// What else a file has is derived from these, or is not of a session.
    pub(crate) fn from_name(name: &str) -> Option<Self> {
        match name {
            Self::WIRE => Some(Self::Wire),
            Self::EVENTS => Some(Self::Events),
            _ => None,
        }
    }
}
