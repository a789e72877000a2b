//! Measures the cost of drawing the graph, per frame.

use std::{thread, time::Duration};

use anyhow::{Context, Result, ensure};
use end_to_end::{
    Bench, Page, View,
    figures::{ms, percentile, row},
};

use crate::{
    samples::updates,
    tap::{Taker, TappedPage},
};

/// The shown period of the graph.
const SHOWN_S: u64 = 60;
/// Duration of the measurement.
const WATCHED_S: u64 = 20;
/// Width of its canvas, in CSS pixels.
const WIDTH: i64 = 1_200;
/// Maximal time of the script of one frame.
const DRAW_US_MAX: u64 = 4_000;
/// The page's name for the measurement of one frame.
const MEASURE: &str = "graph-draw";

pub fn measure() -> Result<()> {
    let bench = Bench::start()?;
    let tapped = TappedPage::open(&bench, View::DESKTOP)?;
    let page = &tapped.page;
    let width = widen(page)?;
    tapped.mute_worker()?;
    let from_us = tapped.now_us()? + 500_000;
    let until_us = from_us + (SHOWN_S + WATCHED_S) * 1_000_000;
    tapped.give(Taker::Page, &updates(from_us, until_us)?)?;
    thread::sleep(Duration::from_secs(SHOWN_S + 1));
    let filling = page.work()?.durations_of(MEASURE).len();
    thread::sleep(Duration::from_secs(WATCHED_S - 2));
    let draws = page.work()?.durations_of(MEASURE);
    ensure!(tapped.waiting()? > 0, "the samples ran out before the end");
    ensure!(
        !draws.is_empty(),
        "the page measured no {MEASURE:?} ({filling} before)"
    );
    let us = |percent| -> Result<u64> {
        let draw = percentile(&draws, percent).context("no draw")?;
        Ok(u64::try_from(draw.as_micros())?)
    };
    let (median, p99, longest) = (us(50)?, us(99)?, us(100)?);
    row(
        &format!("graph, {SHOWN_S} s at 500 Hz, two traces, {width} px"),
        "at most 4 ms of script a frame",
        format!(
            "median {}, 99 of 100 at most {}, longest {} of {} frames",
            ms(median),
            ms(p99),
            ms(longest),
            draws.len()
        ),
        p99 <= DRAW_US_MAX && width >= WIDTH,
    );
    crate::ensure_quiet(page)
}

/// The page has a maximal width; this removes it, so that the graph becomes wide enough.
const UNBOUND: &str = "document.querySelector('main').style.maxWidth = 'none'";

/// Widens the window until the graph has the width that is asked for. Returns the width that it has.
fn widen(page: &Page) -> Result<i64> {
    page.evaluate(UNBOUND)?;
    let mut view = View::DESKTOP;
    let mut width = 0;
    for _ in 0..12 {
        page.look(view)?;
        width = graph_width(page)?;
        let missing = WIDTH - width;
        if missing == 0 {
            break;
        }
        // The graph gets two sevenths of the window's growth.
        view.width = u32::try_from(i64::from(view.width) + missing * 7 / 2)?;
    }
    Ok(width)
}

fn graph_width(page: &Page) -> Result<i64> {
    let graph = page.find_like("img", "Speed and current")?;
    let width = graph.ask("function () { return Math.round(this.clientWidth); }", &[])?;
    width.as_i64().context("the graph has no width")
}
