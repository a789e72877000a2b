//! The fleet: what each robot publishes beside ROS, and `motorlink-fleet`, which shows all of them and drives none. `docs/fleet.md` is for
//! its users.
//!
//! | file | idea |
//! |---|---|
//! | `names` | names, keys, and the texts that are allowed |
//! | `state`, `words` | the state of a robot as JSON |
//! | `publisher` | a robot publishes it |
//! | `sessions` | a robot answers with its session files |
//! | `watch` | which robots are known, and for how long nothing came from each |
//! | `listening` | the Zenoh session that hears all robots |
//! | `table` | all robots as text |
//! | `screen` | all robots on the full screen |
//! | `saving` | the session files of a robot, on this computer |
//! | `program` | `motorlink-fleet` |

mod listening;
pub mod names;
pub mod program;
pub mod publisher;
mod saving;
mod screen;
pub mod sessions;
pub mod state;
mod table;
pub mod watch;
mod words;
