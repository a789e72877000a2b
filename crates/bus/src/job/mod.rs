//! What a scan and an ID change have in common: they have the line to themselves.

mod control;
pub(crate) mod state;
pub(crate) mod status;
