//! Serves the built page from a directory: for a person who looks at it, and for its tests.
//!
//! [`files`] is a router that a program can join with routes of its own. [`Server`] runs one on
//! threads of its own, for programs that do without async code.
//!
//! It is not for the open network: no TLS, no limits on requests. The page itself needs no server;
//! any static host can serve it.
//!
//! ```no_run
//! use std::net::TcpListener;
//! use std::path::Path;
//!
//! use motorlink_web_server::{Delivery, Server, files};
//!
//! let listener = TcpListener::bind("127.0.0.1:8017")?;
//! let server = Server::start(listener, files(Path::new("dist"), Delivery::AsAHost)?)?;
//! println!("the page is at {}/", server.origin());
//! # std::io::Result::Ok(())
//! ```

pub mod compression;
mod files;
mod server;

pub use files::{Delivery, files};
pub use server::Server;
