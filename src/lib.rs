//! The page of MotorLink: what an operator asks of a hub motor, and what the motor does.
//!
//! The page owns no port and decides no frame. It talks to its worker by two enums
//! ([`motorlink_messages`]) and shows what comes back. Anything that can be decided without a
//! browser is a pure function in a file of its own and tested natively; the browser is reached from
//! [`App`]'s components, the links to the workers, `serial_ports`, `download`, `lifecycle` and
//! `keyboard`.

mod acts;
mod alerts;
mod app;
mod assembling;
mod attribute;
mod clock;
mod components;
mod connecting;
mod desk;
mod doctor;
mod download;
mod drawer;
mod drive_pad;
mod entry;
mod fault_history;
mod fleet;
mod format;
mod found_motors;
mod frames;
mod gamepads;
pub mod graph;
mod help_topic;
mod history;
mod id_acts;
mod id_manager;
mod incoming;
mod installation;
mod kept;
mod keyboard;
mod keys;
mod language;
mod lifecycle;
mod line_card;
mod listener;
mod log_feed;
mod log_view;
mod long_drive;
mod mathematics;
mod mirror;
mod motor_chips;
mod new_version;
mod notice_board;
mod one_stop;
mod permission;
mod preferences;
mod question;
mod raw_acts;
mod raw_cells;
pub mod raw_editor;
mod raw_words;
mod recent;
mod recorder;
mod recorder_link;
mod scan_words;
mod serial_ports;
mod session;
pub mod setup;
mod setup_acts;
mod started_worker;
mod tab;
mod target;
mod ticking;
mod together_acts;
mod tool_entry;
mod tour;
pub mod twin;
mod words;
mod worker_link;

pub use app::{App, start};
pub use preferences::{Model, Preferences, Theme};
