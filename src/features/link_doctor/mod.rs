//! How well the line works, and what is wrong with it.

pub(crate) mod figures;
pub(crate) mod markup;
pub(crate) mod panel;
pub(crate) mod quality;
pub(crate) mod texts;
