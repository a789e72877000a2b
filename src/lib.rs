//! The page of MotorLink: what an operator asks of a hub motor, and what the motor does.
//!
//! The page owns no port and decides no frame. It talks to its worker by two enums
//! ([`motorlink_messages`]) and shows what comes back. Anything that can be decided without a
//! browser is a pure function in a file of its own and tested natively; the browser is reached from
//! [`App`]'s components, `worker_link`, `serial_ports`, `lifecycle` and `keyboard`.

mod acts;
mod app;
mod clock;
mod components;
mod connecting;
mod desk;
mod entry;
mod format;
mod incoming;
mod keyboard;
mod keys;
mod lifecycle;
mod listener;
mod mathematics;
mod notice_board;
mod permission;
mod preferences;
mod serial_ports;
mod session;
mod target;
mod ticking;
pub mod twin;
mod words;
mod worker_link;

pub use app::App;
pub use preferences::{Model, Preferences, Theme};
