//! Which motors there are, and which of them is chosen.

pub(crate) mod chips;
pub(crate) mod choice;
pub(crate) mod strip;
