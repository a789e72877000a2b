//! `/foxglove`: what happens on the line, live, for Foxglove, Lichtblick and other programs that plot.
//!
//! It speaks Foxglove's WebSocket protocol
//! (<https://github.com/foxglove/ws-protocol/blob/5efa728/docs/spec.md>), with the channels, schemas and messages of a
//! session file. The crate `foxglove` has a server of its own with its own port, so it cannot be behind the token, the
//! host names and the limits of this server: the part of the protocol that only reads is here.
//!
//! It is read-only. Nothing in this folder has the driver's commander, and the server tells no capabilities.
//!
//! | module | what it holds |
//! |---|---|
//! | `protocol` | the messages, in both directions |
//! | `plot` | the numbers of the telemetry for PlotJuggler |
//! | `clients` | who is connected, what they subscribe to, and their queues |
//! | `feed` | from the entries of the driver to messages |
//! | `socket` | the connection of one client |

mod clients;
mod feed;
mod plot;
mod protocol;
mod socket;

pub(crate) use clients::Clients;
pub(crate) use feed::Feed;
pub(crate) use socket::answer;
