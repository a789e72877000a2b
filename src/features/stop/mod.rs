//! STOP, and the progress of a stop of all motors.

pub(crate) mod alert;
pub(crate) mod button;
pub(crate) mod dialog;
