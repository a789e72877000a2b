//! Measures how soon a first visit can be used, on a slow processor and on a slow network. `cargo xtask bench start` runs this.

use std::process::ExitCode;

use anyhow::{Context, Result};
use end_to_end::{
    Bench, FirstPress, Slowness,
    figures::{Table, percentile, row},
};

/// Slowdown of the processor, as Lighthouse simulates a phone.
const TIMES_SLOWER: f64 = 4.0;
const VISITS: usize = 5;
const USABLE_MS_MAX: f64 = 1_000.0;
const USABLE_ON_SLOW_4G_MS_MAX: f64 = 3_000.0;

fn main() -> ExitCode {
    match measure() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("start: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn measure() -> Result<()> {
    let table = Table::begin()?;
    visits(false, "", USABLE_MS_MAX)?;
    visits(true, " on slow 4G", USABLE_ON_SLOW_4G_MS_MAX)?;
    table.end()
}

fn visits(slow_4g: bool, network: &str, usable_ms_max: f64) -> Result<()> {
    let slowness = Slowness {
        processor: TIMES_SLOWER,
        slow_4g,
    };
    let mut usable = Vec::new();
    let mut whole = Vec::new();
    for _ in 0..VISITS {
        // A new browser, so that nothing is cached from the previous visit.
        let bench = Bench::start_compressed()?;
        let (page, first) = FirstPress::on(&bench, slowness, "Virtual motor")?;
        page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
        usable.push(first.usable_ms);
        whole.push(first.whole_ms);
    }
    let told = |what: &str, must: &str, all: &mut Vec<f64>, ms_max: f64| -> Result<()> {
        all.sort_by(f64::total_cmp);
        let median = percentile(all, 50).context("no visit")?;
        let worst = all.last().context("no visit")?;
        row(
            &format!("{what}{network}, processor slowed {TIMES_SLOWER} times, {VISITS} visits"),
            must,
            format!("median {median:.0} ms, worst {worst:.0} ms"),
            median <= ms_max,
        );
        Ok(())
    };
    let must = format!("at most {usable_ms_max:.0} ms");
    let usable_what = "first visit until `Virtual motor` can be pressed";
    told(usable_what, &must, &mut usable, usable_ms_max)?;
    let whole_what = "first visit until all of the page is there";
    told(whole_what, "", &mut whole, f64::INFINITY)
}
