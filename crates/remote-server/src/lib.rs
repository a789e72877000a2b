//! Serves the page, and lets it watch and drive the motors of a driver on this computer.
//!
//! The program that owns the driver gives its entries to a [`Hub`] and calls [`Hub::turn`]. The hub runs on the thread
//! that takes the entries, so the driver stops the motors if that thread stalls. The web server runs on threads of its
//! own: a page that is slow, dead or hostile delays neither the wire nor the operator. Queues, sizes, rates and the
//! number of pages are limited.
//!
//! A controller on the same computer drives by a Unix socket: `ControlSocket`.
//!
//! `/foxglove` tells other programs what happens on the line; nothing leads from it to the driver. Nor from `/fleet`, which
//! shows other robots.
//!
//! [`motorlink_remote::Control`] and `viewers/operation.rs` decide who may drive, and [`Access`] who may connect. SECURITY.md has the threat model.

#![cfg_attr(
    not(unix),
    allow(dead_code, unused_imports, reason = "there is no socket to be served")
)]

mod access;
mod control_socket;
mod fleet;
mod foxglove;
mod headers;
mod hub;
mod messages;
mod page;
mod server;
mod sessions;
mod socket;
mod tls;
mod viewers;

pub use access::{Access, Token};
#[cfg(unix)]
pub use control_socket::{ControlSocket, NoSocket, RunningSocket};
pub use fleet::Fleet;
pub use hub::Hub;
pub use page::Site;
pub use server::Server;
pub use tls::{Invalid, NoTls, Pem, Tls};
pub use viewers::Viewers;
