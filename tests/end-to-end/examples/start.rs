//! Measures how soon a first visit can be used, on a slow processor and on a slow network, and what a change of one
//! element costs. `cargo xtask bench start` runs this.

use std::process::ExitCode;

use anyhow::{Context, Result};
use end_to_end::{
    Bench, FirstPress, Slowness, View,
    figures::{Table, percentile, row},
};
use serde_json::Value;

/// Slowdown of the processor, as Lighthouse simulates a phone.
const TIMES_SLOWER: f64 = 4.0;
const VISITS: usize = 5;
const USABLE_MS_MAX: f64 = 1_000.0;
const USABLE_ON_SLOW_4G_MS_MAX: f64 = 3_000.0;
/// Where one change lays out the whole desk, this is a third or more. Not all, because a change of all texts also shapes them.
const LAYOUT_MAX: f64 = 0.15;
const LAYOUT: &str = include_str!("layout.js");

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
    layout()?;
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

/// Windows in which the page scrolls and in which it does not.
fn layout() -> Result<()> {
    let bench = Bench::start()?;
    let page = bench.open("/?port=virtual")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.find_like("img", "Speed and current")?;
    for (width, height) in [
        (1440, 1000),
        (1440, 800),
        (1366, 650),
        (1024, 768),
        (390, 844),
    ] {
        page.look(View::window(width, height))?;
        let times = page.evaluate(LAYOUT)?;
        let of = |what: &str| {
            let ms = times.get(what).and_then(Value::as_f64);
            ms.with_context(|| format!("{what} in {times}"))
        };
        let share = of("one")? / of("all")?;
        row(
            &format!(
                "window of {width} x {height}: layout after a change of one element, the worst of 16, against that after one of all texts"
            ),
            &format!("at most {LAYOUT_MAX}"),
            format!("{share:.3}"),
            share <= LAYOUT_MAX,
        );
    }
    Ok(())
}
