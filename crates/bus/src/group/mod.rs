//! Groups: motors that are driven as one.

mod control;
pub(crate) mod setpoints;
pub(crate) mod starting;
