//! What an operator can do, a folder for each feature: its state, its actions, its view, its texts and its tests.
//!
//! No feature imports another; what several of them need is in [`crate::model`].

pub(crate) mod connect;
pub(crate) mod dock;
pub(crate) mod drive;
pub(crate) mod experiments;
pub mod graph;
pub(crate) mod groups;
pub(crate) mod help;
pub(crate) mod ids;
pub(crate) mod install;
pub(crate) mod link_doctor;
pub(crate) mod motors;
pub(crate) mod notices;
pub(crate) mod packet_log;
pub mod raw;
pub(crate) mod recording;
pub(crate) mod remote;
pub(crate) mod rover;
pub(crate) mod saved_session;
pub(crate) mod session_file;
pub(crate) mod settings;
pub(crate) mod setup_link;
pub(crate) mod stop;
pub mod telemetry;
pub(crate) mod wheel_setup;
