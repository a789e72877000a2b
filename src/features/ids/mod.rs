//! Scans and ID changes.

pub(crate) mod actions;
pub(crate) mod found_motors;
pub(crate) mod state;
pub(crate) mod view;
