//! The full scan and the ID query.

mod control;
pub(crate) mod report;
pub(crate) mod state;
