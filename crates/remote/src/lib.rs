//! Remote operation, without I/O.
//!
//! A server owns the motors and several pages watch them. At most one page at a time may drive: the one that holds the
//! lease ([`Control`]). The page renews it every 100 ms by an answer to a challenge. 400 ms after the newest challenge
//! that it has answered was made, the lease ends, and the server stops the motors. All times are those of the server.
//!
//! [`ToServer`] and [`FromServer`] are the messages of the WebSocket.

mod control;
mod wire;

pub use control::{
    ACTS_WITHIN, ANSWER_AGAIN_EVERY, CHALLENGES_EVERY, Control, Ended, FORCE_AFTER, LEASE, NotDone,
    Taken, VIEWERS_MAX, ViewerId,
};
pub use wire::{FromServer, Stamp, ToServer, Viewer};
