//! How a port with motors is opened: which of several that are alike, for which model, and what happens to motors that
//! an earlier program left driven. Page and native driver do this; only their ports and clocks differ.
//!
//! Nothing here does input or output. The caller does what [`Opening::step`] says, and runs the [`motorlink_bus::Bus`] of
//! the open port meanwhile.
//!
//! - Motors that were left driven are stopped first, if they can be on no other port.
//! - Otherwise all ports that are alike are asked which of them has a motor that turns. Nothing but queries goes out
//!   before that is known.
//! - A port is opened for one model after the other until its motors answer.

mod model_search;
mod opening;
mod order;
mod step;

pub use opening::Opening;
pub use step::{IfNoReply, Others, Step};
