//! The saved session.

pub(crate) mod actions;
pub(crate) mod offer;
pub(crate) mod texts;
pub(crate) mod view;
