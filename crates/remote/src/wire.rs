//! The messages of the WebSocket. Each is one binary message, encoded with postcard.

use motorlink_protocol::Instant;
use serde::{Deserialize, Serialize};

/// From the page to the server.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ToServer {
    /// The page has answered a challenge.
    Answer {
        /// The challenge.
        challenge: u64,
    },
    /// What a person did.
    Act {
        /// Where it stands among what was done.
        stamp: Stamp,
        /// How long ago it was done, in milliseconds of the page's computer.
        age_ms: u32,
        /// A [`ToWorker`](motorlink_messages::ToWorker).
        message: Vec<u8>,
    },
    /// The page asks for control.
    Take {
        /// Whether it takes it from another operator.
        by_force: bool,
    },
    /// The operator gives up control.
    GiveUp,
}

/// Where an act stands among what was done. An act that is late, doubled, out of order or of another lease has no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// The number of the lease.
    pub epoch: u32,
    /// Each act of a lease has a higher one.
    pub sequence: u32,
    /// The newest challenge that the page had answered. It says when the act was done at the earliest.
    pub challenge: u64,
}

/// From the server to the page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromServer {
    /// The first message.
    Hello {
        /// The time of the server.
        now: Instant,
    },
    /// To be answered by the main thread of the page.
    Challenge(u64),
    /// A [`ToPage`](motorlink_messages::ToPage), for the page and the recorder.
    Page(Vec<u8>),
    /// Line events, as the recorder reads them ([`push_traffic`](motorlink_messages::recorder::push_traffic)).
    Traffic(Vec<u8>),
    /// Who drives.
    Control {
        /// The number of the lease, for its holder only.
        epoch: Option<u32>,
        /// The page that it goes to.
        you: u32,
        /// Who drives.
        operator: Option<Viewer>,
        /// Who asks the operator for control.
        asks: Option<Viewer>,
    },
    /// The page was too slow: messages before this one were left out.
    Missed,
}

/// A page or a controller that is connected to the server.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Viewer {
    /// Its number, counted from 1 since the server has started.
    pub number: u32,
    /// Its network address, such as `192.168.1.20`; `socket` for a controller on the computer of the server.
    pub address: String,
}
