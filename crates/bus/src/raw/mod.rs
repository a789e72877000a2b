//! Raw frames: bytes that an operator wrote.

mod checks;
mod control;
pub(crate) mod frame;
pub(crate) mod hazard;
pub(crate) mod status;
