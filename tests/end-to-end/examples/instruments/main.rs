//! Measures the instruments: scans, the graph, the packet log and its export. Prints a table.
//!
//! `cargo xtask bench` builds everything and runs this after `figures`. `--seconds N` shortens the long run, `--only
//! scans`, `graph` or `log` measures a part.

mod graph;
mod log;
mod samples;
mod scans;
mod tap;
mod traffic;

use std::{env, process::ExitCode};

use anyhow::{Context, Result, bail, ensure};
use end_to_end::{Page, figures::Table};

/// Duration of sending frames to the log.
const FED_S: u64 = 600;

fn main() -> ExitCode {
    match wanted().and_then(|wanted| measure(&wanted)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("instruments: {error:#}");
            ExitCode::FAILURE
        }
    }
}

struct Wanted {
    seconds: u64,
    only: Option<String>,
}

fn wanted() -> Result<Wanted> {
    let mut wanted = Wanted {
        seconds: FED_S,
        only: None,
    };
    let mut arguments = env::args().skip(1);
    while let Some(flag) = arguments.next() {
        match (flag.as_str(), arguments.next()) {
            ("--seconds", Some(number)) => {
                wanted.seconds = number.parse().context("--seconds takes a whole number")?;
            }
            ("--only", Some(part)) if ["scans", "graph", "log"].contains(&part.as_str()) => {
                wanted.only = Some(part);
            }
            _ => bail!("usage: instruments [--seconds N] [--only scans|graph|log]"),
        }
    }
    Ok(wanted)
}

/// Measures the selected parts. If one of them fails, the others are still measured.
fn measure(wanted: &Wanted) -> Result<()> {
    let seconds = wanted.seconds;
    let parts: [(&str, &dyn Fn() -> Result<()>); 3] = [
        ("scans", &scans::measure),
        ("graph", &graph::measure),
        ("log", &|| log::measure(seconds)),
    ];
    let is_wanted = |part: &str| wanted.only.as_ref().is_none_or(|only| only == part);
    let table = Table::begin()?;
    let mut failed = None;
    for (part, measure) in parts.iter().filter(|(part, _)| is_wanted(part)) {
        if let Err(error) = measure() {
            println!("| {part} | | could not be measured: {error:#} | NO |");
            failed.get_or_insert(*part);
        }
    }
    table.end()?;
    match failed {
        Some(part) => bail!("{part} could not be measured"),
        None => Ok(()),
    }
}

fn ensure_quiet(page: &Page) -> Result<()> {
    let errors = page.console_errors();
    ensure!(errors.is_empty(), "the console is not empty: {errors:?}");
    Ok(())
}
