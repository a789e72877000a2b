//! ROS 2 topics for the motors of a running motorlink, over Zenoh, without ROS installed. `docs/ros.md` is for its users.
//!
//! | module | idea |
//! |---|---|
//! | `arguments` | the command line |
//! | `node` | a node of ROS 2 over Zenoh: keys, tokens, attachments, messages |
//! | `motorlink` | the connection to `motorlink serve --socket`, which owns the port and stops the motors |
//! | `rover` | from a twist to wheels and back |
//! | `cmd_vel` | the newest command, and for how long it counts |
//! | `drive` | when the motors are armed, moved and stopped |
//! | `odometry` | where the robot is |
//! | `telemetry`, `diagnostics` | states as messages |
//! | `robot` | the loop |
//! | `network` | what the loop is told from ROS, and what it sends there |
//! | `run` | the program |

pub mod arguments;
pub mod cmd_vel;
pub mod diagnostics;
pub mod drive;
pub mod motorlink;
pub mod network;
pub mod node;
pub mod odometry;
pub mod robot;
pub mod rover;
pub mod run;
pub mod telemetry;

use std::io::{self, Write as _};

/// Tells the person at the terminal. Nobody may read it.
fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}
