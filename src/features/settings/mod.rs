//! Limits, the setup as a file, and what the browser keeps.

pub(crate) mod actions;
pub(crate) mod panel;
pub(crate) mod texts;
