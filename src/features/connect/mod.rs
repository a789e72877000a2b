//! From a press of Connect to an open port.

pub(crate) mod actions;
pub(crate) mod first_screen;
pub(crate) mod panel;
pub(crate) mod to_try;
pub(crate) mod view;
