//! Groups of motors, and the drive pad.

pub(crate) mod actions;
pub(crate) mod gamepads;
pub(crate) mod pad;
pub(crate) mod pad_view;
pub(crate) mod panel;
pub(crate) mod rows;
pub(crate) mod wheels;
