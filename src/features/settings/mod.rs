//! Limits, export and import of the setup, and deleting stored data.

pub(crate) mod actions;
pub(crate) mod panel;
pub(crate) mod texts;
