//! The worker of a page that comes from a server: it connects page and server. No port is opened in this browser.
//!
//! It decides nothing. It passes on what the page does, with a stamp, and what the server says. The main thread of the page
//! answers each challenge of the server, so a page that hangs loses its lease.

mod group;
mod relay;
mod socket;

pub(crate) use relay::start;
