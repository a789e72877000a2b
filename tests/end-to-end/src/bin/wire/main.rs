//! Measures how much of the bus capacity the page uses, with one motor and with many, and its cost. Prints a table.
//!
//! `cargo xtask bench` builds everything and runs this after `instruments`. `--seconds N` sets the duration of each
//! measurement, and `--only bare`, `rates`, `crowd`, `rover`, `load`, `drawing`, `models`, `stop`, `stall`, `runs`, `saving` or
//! `heap` measures a part.
//! The heap is measured ten times as long, and the graph of `stop` fills for five times as long.

mod bare;
mod crowd;
mod drawing;
mod driving;
mod load;
mod models;
mod rates;
mod rover;
mod runs;
mod saving;
mod stall;
mod stop;

use std::{env, process::ExitCode, time::Duration};

use anyhow::{Context, Result, bail, ensure};
use end_to_end::{Page, figures::Table};

/// Duration of each measurement.
const WATCHED_S: u64 = 60;

const PARTS: [&str; 12] = [
    "bare", "rates", "crowd", "rover", "load", "drawing", "models", "stop", "stall", "runs",
    "saving", "heap",
];

fn main() -> ExitCode {
    match wanted().and_then(|wanted| measure(&wanted)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("wire: {error:#}");
            ExitCode::FAILURE
        }
    }
}

struct Wanted {
    watched: Duration,
    only: Option<String>,
}

fn wanted() -> Result<Wanted> {
    let mut wanted = Wanted {
        watched: Duration::from_secs(WATCHED_S),
        only: None,
    };
    let mut arguments = env::args().skip(1);
    while let Some(flag) = arguments.next() {
        match (flag.as_str(), arguments.next()) {
            ("--seconds", Some(number)) => {
                let seconds = number.parse().context("--seconds takes a whole number")?;
                wanted.watched = Duration::from_secs(seconds);
            }
            ("--only", Some(part)) if PARTS.contains(&part.as_str()) => wanted.only = Some(part),
            _ => bail!(
                "usage: wire [--seconds N] [--only bare|rates|crowd|rover|load|drawing|models|stop|stall|runs|saving|heap]"
            ),
        }
    }
    Ok(wanted)
}

/// Measures the selected parts. If one of them fails, the others are still measured.
fn measure(wanted: &Wanted) -> Result<()> {
    let table = Table::begin()?;
    let mut failed = None;
    let is_wanted = |part: &str| wanted.only.as_ref().is_none_or(|only| only == part);
    for part in PARTS.into_iter().filter(|part| is_wanted(part)) {
        let measured = match part {
            "bare" => bare::measure(wanted.watched),
            "rates" => rates::measure(wanted.watched),
            "crowd" => crowd::measure(wanted.watched),
            "rover" => rover::measure(wanted.watched),
            "load" => load::measure(wanted.watched),
            "drawing" => drawing::measure(wanted.watched),
            "models" => models::measure(wanted.watched),
            "stop" => stop::measure(wanted.watched),
            "stall" => stall::measure(),
            "runs" => runs::measure(wanted.watched),
            "saving" => saving::measure(wanted.watched),
            _ => load::measure_heap(wanted.watched),
        };
        if let Err(error) = measured {
            println!("| {part} | | could not be measured: {error:#} | NO |");
            failed.get_or_insert(part);
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
