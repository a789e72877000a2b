//! The found motors, and the selection.

pub(crate) mod chips;
pub(crate) mod choice;
pub(crate) mod strip;
