//! Plays records: the messages that the page would have got at a place of the session.
//!
//! | file | what it holds |
//! |---|---|
//! | `player` | requests of the page in, messages to it out |
//! | `playing` | the place while it plays |
//! | `search` | the state at another place |
//! | `track` | reads records up to a time |
//! | `replayed_state` | what the page shows |
//! | `of_frames` | the same for records without states: what the frames tell |
//! | `log_rows` | rows of the packet log |
//! | `times`, `look_back` | the clock of a replay, and how far it reads back |

mod log_rows;
mod look_back;
mod of_frames;
mod player;
mod playing;
mod replayed_state;
mod search;
mod times;
mod track;

pub use look_back::LookBack;
pub use player::{Player, Todo};
