//! Measures `motorlink serve`: how late its frames and stops are with many pages, and on a network that loses packets.
//! Prints a table.
//!
//! `cargo xtask bench remote` builds everything and runs this. `--seconds N` sets the duration of each measurement, and
//! `--only` with `stops`, `networks`, `cost` or `crowd` measures a part. `networks` needs root: a network between two
//! namespaces of this computer delays and loses the packets.

mod crowd;
mod network;
#[path = "../../../../crates/remote-server/tests/support/page.rs"]
mod page;
mod server;
mod stops;

use std::{env, process::ExitCode, time::Duration};

use anyhow::{Context, Result, bail};
use end_to_end::figures::Table;

/// Duration of each measurement.
const WATCHED_S: u64 = 600;

fn main() -> ExitCode {
    match measure() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("remote: {error:#}");
            ExitCode::FAILURE
        }
    }
}

type Measurement = fn(Duration) -> Result<()>;

/// The measurements, by the names of `--only`.
const PARTS: [(&str, Measurement); 4] = [
    ("stops", |_| stops::loopback()),
    ("networks", stops::over_networks),
    ("cost", |_| crowd::cost()),
    ("crowd", crowd::many_viewers),
];

fn measure() -> Result<()> {
    let mut lasts = Duration::from_secs(WATCHED_S);
    let mut only = None;
    let mut arguments = env::args().skip(1);
    while let Some(flag) = arguments.next() {
        match (flag.as_str(), arguments.next()) {
            ("--seconds", Some(number)) => {
                let seconds = number.parse().context("--seconds takes a whole number")?;
                lasts = Duration::from_secs(seconds);
            }
            ("--only", Some(part)) if PARTS.iter().any(|(name, _)| *name == part) => {
                only = Some(part);
            }
            _ => bail!("it takes --seconds N and --only stops, networks, cost or crowd"),
        }
    }
    let table = Table::begin()?;
    for (name, measure) in PARTS {
        if only.as_ref().is_none_or(|only| only == name) {
            measure(lasts)?;
        }
    }
    table.end()
}
