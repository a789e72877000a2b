//! Scans, and the way to a new ID.

pub(crate) mod actions;
pub(crate) mod found_motors;
pub(crate) mod state;
pub(crate) mod view;
