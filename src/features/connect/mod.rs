//! From a press of Connect to an open port.

pub(crate) mod actions;
pub(crate) mod panel;
pub(crate) mod view;
