//! Remote operation, without I/O.
//!
//! A server owns the motors, and pages and controllers watch them. At most one of them at a time may drive: the one that
//! holds the lease ([`Control`]). A page renews it every 100 ms by an answer to a challenge, and a controller every 10 ms.
//! 400 ms after the newest challenge that the page has answered was made, or 100 ms for a controller, the lease ends, and the
//! server stops the motors. All times are those of the server.
//!
//! [`ToServer`] and [`FromServer`] are the messages of the WebSocket.

mod control;
mod wire;

pub use control::{
    ACTS_WITHIN, ANSWER_AGAIN_EVERY, CHALLENGES_EVERY, CONTROLLER_CHALLENGES_EVERY,
    CONTROLLER_LEASE, CONTROLLERS_MAX, Control, Ended, FORCE_AFTER, LEASE, NotDone, Participant,
    Taken, VIEWERS_MAX, ViewerId,
};
pub use wire::{FromServer, Stamp, ToServer, Viewer};
