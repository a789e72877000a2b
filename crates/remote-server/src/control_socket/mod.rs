//! The socket of `motorlink serve --socket`: a controller on this computer drives the motors.
//!
//! `docs/socket.md` describes every byte; `crates/controller-messages` has the messages. A controller is one more holder of the lease beside the pages
//! ([`motorlink_remote::Control`]): it has 100 ms where a page has 400 ms. Text clients read the state and may stop.
//!
//! | module | what it holds |
//! |---|---|
//! | `snapshot` | the newest state of each motor, from the entries of the driver |
//! | `connection` | the connection of one client |
//! | `refusal` | why a connection is closed |
//! | `text` | the text form |
//! | `listener` | the file of the socket, and who is let in |
//!
//! What a controller may do is decided in `viewers/operation.rs`.

#[cfg(unix)]
mod connection;
#[cfg(unix)]
mod listener;
#[cfg(unix)]
mod refusal;
mod snapshot;
#[cfg(unix)]
mod text;

#[cfg(unix)]
pub use listener::{ControlSocket, NoSocket, RunningSocket};
pub(crate) use snapshot::{Feed, Snapshot};
