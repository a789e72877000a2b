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
//! | `status` | how the drive and the motors are |
//! | `telemetry`, `diagnostics` | states as messages |
//! | `fleet` | what all robots of a network publish, and the program that shows it |
//! | `robot` | the loop |
//! | `network` | what the loop is told from ROS, and what it sends there |
//! | `run` | the program |

pub mod arguments;
pub mod cmd_vel;
pub mod diagnostics;
pub mod drive;
pub mod fleet;
pub mod motorlink;
pub mod network;
pub mod node;
pub mod odometry;
pub mod robot;
pub mod rover;
pub mod run;
pub mod status;
pub mod telemetry;

use std::{
    io::{self, Write as _},
    sync::{
        OnceLock,
        mpsc::{self, SyncSender},
    },
    thread,
    time::Duration,
};

/// Lines that wait for the terminal. One that does not read loses the next ones.
const LINES_MAX: usize = 64;

/// What the thread that writes is told.
enum Line {
    Text(String),
    /// Everything before it is written.
    Written(SyncSender<()>),
}

fn lines() -> &'static SyncSender<Line> {
    static LINES: OnceLock<SyncSender<Line>> = OnceLock::new();
    LINES.get_or_init(|| {
        let (lines, waiting) = mpsc::sync_channel(LINES_MAX);
        thread::spawn(move || {
            for line in waiting {
                match line {
                    // Nobody may read it.
                    Line::Text(text) => drop(writeln!(io::stderr(), "{text}")),
                    Line::Written(done) => drop(done.send(())),
                }
            }
        });
        lines
    })
}

/// Tells the person at the terminal. A terminal that is stopped delays nothing.
fn say(text: &str) {
    let _ = lines().try_send(Line::Text(text.to_owned()));
}

/// Waits until everything is said, a moment at most.
fn wait_until_said() {
    let (done, written) = mpsc::sync_channel(1);
    let _ = lines().try_send(Line::Written(done));
    let _ = written.recv_timeout(Duration::from_millis(200));
}
