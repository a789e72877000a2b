//! What the page knows, and what features share.

pub(crate) mod desk;
pub(crate) mod drawer;
pub(crate) mod fleet;
pub(crate) mod guards;
pub(crate) mod help_topic;
pub(crate) mod history;
pub(crate) mod log_lines;
pub(crate) mod mirror;
pub(crate) mod notice_board;
pub(crate) mod notice_lifetime;
pub(crate) mod notice_texts;
pub(crate) mod preferences;
pub(crate) mod scan_texts;
pub mod setup;
pub(crate) mod snapshot;
pub(crate) mod tab;
pub(crate) mod target;
pub(crate) mod terms;
