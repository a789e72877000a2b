//! Measures how soon a first visit can be used, on a slow processor. `cargo xtask bench start` runs this.

use std::process::ExitCode;

use anyhow::{Context, Result};
use end_to_end::{
    Bench, FirstPress,
    figures::{Table, percentile, row},
};

/// Slowdown of the processor, as Lighthouse simulates a phone.
const TIMES_SLOWER: f64 = 4.0;
const VISITS: usize = 5;
const USABLE_MS_MAX: f64 = 1_500.0;

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
    let mut usable = Vec::new();
    let mut whole = Vec::new();
    for _ in 0..VISITS {
        // A new browser, so that nothing is cached from the previous visit.
        let bench = Bench::start()?;
        let (page, first) = FirstPress::on(&bench, TIMES_SLOWER, "Virtual motor")?;
        page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
        usable.push(first.usable_ms);
        whole.push(first.whole_ms);
    }
    let told = |what: &str, must: &str, all: &mut Vec<f64>, ms_max: f64| -> Result<()> {
        all.sort_by(f64::total_cmp);
        let median = percentile(all, 50).context("no visit")?;
        let worst = all.last().context("no visit")?;
        row(
            &format!("{what}, processor slowed {TIMES_SLOWER} times, {VISITS} visits"),
            must,
            format!("median {median:.0} ms, worst {worst:.0} ms"),
            median <= ms_max,
        );
        Ok(())
    };
    let must = format!("at most {USABLE_MS_MAX:.0} ms");
    let usable_what = "first visit until `Virtual motor` can be pressed";
    told(usable_what, &must, &mut usable, USABLE_MS_MAX)?;
    let whole_what = "first visit until all of the page is there";
    told(whole_what, "", &mut whole, f64::INFINITY)?;
    table.end()
}
