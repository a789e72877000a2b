//! STOP, and how a stop of all motors goes.

pub(crate) mod button;
pub(crate) mod dialog;
