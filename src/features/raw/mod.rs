//! Frames that the user writes.

pub(crate) mod actions;
pub(crate) mod cells;
pub mod editor;
pub(crate) mod texts;
pub(crate) mod view;
