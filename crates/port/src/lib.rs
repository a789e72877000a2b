//! A port with motors, as the page and the native driver have it: which of several that are alike is opened, for which
//! model, what happens to motors that an earlier program left driven, and how the bus runs on the open line. Only their
//! ports and clocks differ.
//!
//! Nothing here does input or output but through [`Line`]. The caller does what [`Opening::step`] says, and runs the
//! [`motorlink_bus::Bus`] of the open port by [`PortControl::turn`].
//!
//! - Motors that were left driven are stopped first, if they can be on no other port.
//! - Otherwise all ports that are alike are asked which of them has a motor that turns. Nothing but queries goes out
//!   before that is known.
//! - A port is opened for one model after the other until its motors answer.
//! - The caller can remember what is driven before its first frame.

mod host;
mod line;
mod model_search;
mod opening;
mod order;
mod port_control;
mod step;

pub use host::{BusEnd, Host, Turned};
pub use line::{Line, Written};
pub use opening::Opening;
pub use port_control::{NotDone, PortControl};
pub use step::{IfNoReply, Others, Step};
