//! The page of MotorLink: what an operator asks of a hub motor, and what the motor does.
//!
//! The page owns no port and decides no frame. It talks to its worker by two enums
//! ([`motorlink_messages`]) and shows what comes back. Anything that can be decided without a
//! browser is a pure function in a file of its own and tested natively; the browser is reached from
//! [`App`]'s components, the links to the workers, `serial_ports`, `download`, `lifecycle` and
//! `keyboard`.

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
