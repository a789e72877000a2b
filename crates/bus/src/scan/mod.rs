//! The full scan and the ID query.

mod address;
mod control;
mod reply_times;
pub(crate) mod report;
pub(crate) mod state;
