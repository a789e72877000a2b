//! `motorlink-fleet`, from its arguments to its end.

use std::{
    io::{self, Read as _, Write as _},
    path::PathBuf,
    sync::mpsc::{self, RecvTimeoutError},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Result, bail, ensure};
use clap::{Parser, Subcommand};
use serde::Serialize;
use zenoh::Wait as _;

use super::{
    listening::{Listening, View, client, open},
    names::RobotName,
    saving, screen, table,
    watch::Row,
};
use crate::{arguments::Network, wait_until_said};

/// How often `--json` prints a line.
const PERIOD: Duration = Duration::from_secs(1);
/// Each robot publishes ten states a second: after so long, all are heard.
const HEARD_WITHIN: Duration = Duration::from_secs(2);

/// All robots of a Zenoh network, each with its motorlink-ros. This program drives none of them.
#[derive(Debug, Parser)]
#[command(version, name = "motorlink-fleet")]
pub struct Fleet {
    #[command(flatten)]
    network: Network,
    /// Prints one line of JSON a second.
    #[arg(long)]
    json: bool,
    /// Prints the table once, as text. Usual where the output is no terminal.
    #[arg(long, conflicts_with = "json")]
    once: bool,
    /// With --json: ends when its standard input ends.
    #[arg(long, requires = "json")]
    until_stdin_ends: bool,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Lists the session files of a robot.
    Sessions {
        /// Its name.
        robot: RobotName,
    },
    /// Saves a session file of a robot on this computer. Overwrites nothing.
    Save {
        /// Its name.
        robot: RobotName,
        /// The session file.
        file: String,
        /// Where it is saved. Usually here, under its own name.
        #[arg(long, value_name = "PATH")]
        to: Option<PathBuf>,
    },
}

#[derive(Serialize)]
struct JsonLine<'a> {
    robots: &'a [Row],
    ignored: u64,
    router: bool,
}

impl Fleet {
    /// Runs it.
    ///
    /// # Errors
    ///
    /// For input that is wrong, without a router, and without the robot that is asked for.
    pub fn run(self) -> Result<()> {
        let config = client(&self.network)?;
        match self.command {
            Some(Command::Sessions { robot }) => {
                let session = open(config)?;
                let files = saving::list(&session, &robot)?;
                ensure!(!files.is_empty(), "{robot} has no session files");
                for file in files {
                    print(&format!("{:>12}  {}\n", file.bytes, file.name))?;
                }
                let _ = session.close().wait();
                Ok(())
            }
            Some(Command::Save { robot, file, to }) => {
                let session = open(config)?;
                let (path, bytes) = saving::save(&session, &robot, &file, to)?;
                let _ = session.close().wait();
                print(&format!("saved {}, {bytes} bytes\n", path.display()))
            }
            None if self.json => {
                print_lines(&Listening::start(config, true), self.until_stdin_ends);
                Ok(())
            }
            None if self.once || !screen::is_there() => once(&Listening::start(config, true)),
            None => screen::show(&Listening::start(config, false)),
        }
    }
}

/// Prints the table when all robots are heard.
fn once(listening: &Listening) -> Result<()> {
    thread::sleep(HEARD_WITHIN);
    let View {
        rows,
        ignored,
        has_router,
    } = listening.view();
    if !has_router {
        // It is said why.
        wait_until_said();
        bail!("no Zenoh router: nothing is known of any robot");
    }
    ensure!(
        !rows.is_empty(),
        "no robot: start motorlink-ros on each, connected to this router ({ignored} messages ignored)"
    );
    print(&table::plain(&rows, ignored, has_router))
}

/// Prints one line a second until nobody reads them, or stdin ends.
fn print_lines(listening: &Listening, until_stdin_ends: bool) {
    let (to, ended) = mpsc::channel::<()>();
    if until_stdin_ends {
        thread::spawn(move || {
            let mut bytes = [0; 4_096];
            while io::stdin().read(&mut bytes).is_ok_and(|read| read > 0) {}
            drop(to);
        });
    } else {
        // It never ends.
        std::mem::forget(to);
    }
    let mut next = Instant::now() + PERIOD;
    loop {
        let wait = next.saturating_duration_since(Instant::now());
        if ended.recv_timeout(wait) == Err(RecvTimeoutError::Disconnected) {
            return;
        }
        next = (next + PERIOD).max(Instant::now());
        let view = listening.view();
        let line = JsonLine {
            robots: &view.rows,
            ignored: view.ignored,
            router: view.has_router,
        };
        // Numbers and strings always are JSON.
        let mut line = serde_json::to_string(&line).unwrap_or_default();
        line.push('\n');
        if print(&line).is_err() {
            return;
        }
    }
}

fn print(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    Ok(stdout.flush()?)
}
