//! Another ID for the only motor on the bus.

mod control;
pub(crate) mod outcome;
pub(crate) mod state;
