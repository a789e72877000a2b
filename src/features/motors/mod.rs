//! The found motors, the selection, and their names and sides.

pub(crate) mod chips;
pub(crate) mod choice;
pub(crate) mod name_dialog;
pub(crate) mod strip;
