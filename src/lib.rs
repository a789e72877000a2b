//! The page of MotorLink: what an operator asks of a hub motor, and what the motor does.
//!
//! The page owns no port and decides no frame. It talks to its worker by two enums
//! ([`motorlink_messages`]) and shows what comes back. Anything that can be decided without a
//! browser is a pure function in a file of its own and tested natively; the browser is reached from
//! [`App`]'s components, the links to the workers, `serial_ports`, `download`, `lifecycle` and
//! `keyboard`.

// The tests in `src` run natively only: for the browser, the library is empty as a program of tests. Clippy checks them
// there all the same. Tests that need a browser are in `tests/page`.
#![cfg(any(not(test), not(target_arch = "wasm32"), clippy))]

mod app;
mod features;
#[cfg(any(test, feature = "fuzzing"))]
pub mod fuzzing;
mod link;
mod model;
mod ui;

pub use app::{App, start};
pub use features::{graph::plot as graph, telemetry::twin};
pub use model::preferences::{Preferences, Theme};
