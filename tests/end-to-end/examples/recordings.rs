//! Measures an hour at 500 exchanges a second in the page: opening, jumps, scrubbing and memory. `cargo xtask bench
//! recordings` writes the file and runs this.

use std::{env, path::PathBuf, process::ExitCode, thread, time::Duration};

use anyhow::{Context, Result};
use end_to_end::{
    Bench, Memory, Page, View,
    figures::{Table, percentile, ratio, row},
};
use serde::Deserialize;

const HOUR: &str = "session of one hour at 500 exchanges a second, in the browser";

/// Runs in the page.
const SCRIPT: &str = include_str!("recordings.js");

const JUMPS: u64 = 100;
const SCRUB_S: u64 = 10;

/// The motor in the file gets a new speed each four seconds: `-120`, `-80` and so on up to `120`.
const STEP_US: u64 = 4_000_000;

fn main() -> ExitCode {
    match measure() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("recordings: {error:#}");
            ExitCode::FAILURE
        }
    }
}

#[derive(Deserialize)]
struct Opening {
    opened_ms: f64,
    pictured_ms: f64,
}

#[derive(Deserialize)]
struct Scrub {
    frames: f64,
    longest_ms: f64,
    shown: f64,
}

fn measure() -> Result<()> {
    let file = env::var_os("MOTORLINK_HOUR").context("MOTORLINK_HOUR names the session file")?;
    let table = Table::begin()?;
    let bench = Bench::start()?;
    let page = bench.open("/")?;
    page.look(View::DESKTOP)?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    page.open_panel("Session file")?;
    page.find("button", "Open recording")?;
    page.evaluate(&format!("{SCRIPT}; true"))?;

    page.evaluate("recordings.watchOpening()")?;
    page.upload("Open recording", &PathBuf::from(file))?;
    let opening: Opening = serde_json::from_value(page.evaluate("recordings.opening")?)?;
    told(
        "from the choice of the file to `Opened`",
        "at most 3 s",
        opening.opened_ms,
        3_000.0,
    );
    told(
        "from the choice of the file to the drawn picture",
        "at most 1 s",
        opening.pictured_ms,
        1_000.0,
    );

    page.wait_for_text("status", "Connection", |text| text.contains("Replay"))?;
    page.click("button", "Pause replay")?;
    // What is loaded for the first time is not a part of a jump.
    thread::sleep(Duration::from_secs(2));
    page.drop_accessibility_tree()?;
    jumps(&page)?;
    scrub(&page)?;
    // The other figures hold without it.
    let measured = memory(&page);
    table.end()?;
    measured
}

fn told(what: &str, must: &str, ms: f64, ms_max: f64) {
    row(
        &format!("{HOUR}: {what}"),
        must,
        format!("{ms:.0} ms"),
        ms <= ms_max,
    );
}

fn jumps(page: &Page) -> Result<()> {
    // Places that lie apart, near the end of a step, each with another speed than the one before.
    let places: Vec<(u64, i64)> = (0..JUMPS)
        .map(|n| {
            let step = n * 377 % 899;
            let rpm = i64::try_from(step % 7).unwrap_or_default() * 40 - 120;
            (step * STEP_US + 3_500_000, rpm)
        })
        .collect();
    let mut times: Vec<f64> = Vec::new();
    // The browser has to answer each call in 20 s.
    for places in places.chunks(10) {
        let places = serde_json::to_string(places)?;
        let some = page.evaluate(&format!("recordings.jumps({places})"))?;
        times.extend(serde_json::from_value::<Vec<f64>>(some)?);
    }
    let first = *times.first().context("no jump")?;
    times.sort_by(f64::total_cmp);
    let at = |percent| percentile(&times, percent).context("no jump");
    let (median, most, worst) = (at(50)?, at(95)?, at(100)?);
    row(
        &format!("{HOUR}: a jump anywhere, from the slider to the drawn frame"),
        "at most 50 ms",
        format!(
            "median {median:.0} ms, 95 of 100 at most {most:.0} ms, worst {worst:.0} ms of {JUMPS}, the first {first:.0} ms"
        ),
        worst <= 50.0,
    );
    Ok(())
}

fn scrub(page: &Page) -> Result<()> {
    let idle = page.evaluate("recordings.idle(3)")?;
    let idle = idle.as_f64().context("no frames")?;
    let scrub: Scrub =
        serde_json::from_value(page.evaluate(&format!("recordings.scrub({SCRUB_S})"))?)?;
    row(
        &format!("{HOUR}: scrubbing for {SCRUB_S} s"),
        "60 frames of the screen a second, where the machine can",
        format!(
            "{:.1} frames a second, of {idle:.1} that it draws without; longest gap {:.0} ms; {:.1} places a second shown",
            scrub.frames, scrub.longest_ms, scrub.shown
        ),
        scrub.frames >= 0.95 * idle.min(60.0),
    );
    Ok(())
}

/// The whole page with its session worker: more than what the open file adds.
fn memory(page: &Page) -> Result<()> {
    let bytes = |memory: Memory| memory.script + memory.wasm;
    let worker = bytes(page.memory_of_worker("sessions")?);
    let page = bytes(page.memory()?);
    let whole = ratio(worker + page, 1_000_000);
    row(
        &format!("{HOUR}: memory of page and session worker while it is open, after the jumps"),
        "under 150 MB",
        format!(
            "{whole:.1} MB: session worker {:.1}, page {:.1}",
            ratio(worker, 1_000_000),
            ratio(page, 1_000_000)
        ),
        whole < 150.0,
    );
    Ok(())
}
