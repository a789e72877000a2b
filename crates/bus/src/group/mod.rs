//! Groups: motors that are driven as one.

mod control;
pub(crate) mod setpoints;
mod starting;
pub(crate) mod waiting;
