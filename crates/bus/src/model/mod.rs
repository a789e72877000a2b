//! What differs between models: the units and the loops of their frames, and what their replies tell.

pub(crate) mod enabling;
pub(crate) mod evidence;
mod foreign_frames;
pub(crate) mod foreign_text;
pub(crate) mod loop_known;
pub(crate) mod odometry;
pub(crate) mod separate;
pub(crate) mod units;
