//! Measures a stop under full load: eight motors, a full bus, all of it in the log, five minutes of graph.

use std::{thread, time::Duration};

use anyhow::{Context, Result};
use end_to_end::{
    Adapter, Bench, Page,
    figures::{ms, ratio, row},
};

use crate::{
    crowd::{drive, line},
    driving::watch,
};

const MOTORS: u8 = 8;
const STOPS: usize = 50;
/// Time to fill the graph, as a multiple of the duration of other measurements.
const FILLED_TIMES: u32 = 5;
const STOP_MAX_US: u64 = 8_000;

pub fn measure(watched: Duration) -> Result<()> {
    let bench = Bench::start()?;
    let (adapter, page) = crate::driving::connected(&bench, line(MOTORS))?;
    page.click("checkbox", "Collapse status polls")?;
    page.click("radio", "5 min")?;
    drive(&page, MOTORS, MOTORS)?;
    let filled = watch(&adapter, watched * FILLED_TIMES)?;
    let entries_hz = ratio(
        filled.len() as u64,
        (watched * FILLED_TIMES).as_secs().max(1),
    );
    let mut longest_us = 0;
    for _ in 0..STOPS {
        longest_us = longest_us.max(stop(&adapter, &page)?);
        page.click("button", "Release")?;
        page.click("button", "Start group")?;
        page.wait_for_text("output", "Speed", |text| text.contains("100"))?;
        thread::sleep(Duration::from_millis(500));
    }
    row(
        &format!(
            "stop key to first stop frame, page with {MOTORS} motors and a full log and graph, longest of {STOPS}"
        ),
        "at most 8 ms",
        format!("{}, {entries_hz:.0} log entries a second", ms(longest_us)),
        longest_us <= STOP_MAX_US,
    );
    crate::ensure_quiet(&page)
}

/// Time from the key event in the browser to the first brake on the wire.
fn stop(adapter: &Adapter, page: &Page) -> Result<u64> {
    let pressed = page.press_timed("Escape")?;
    page.wait_for_text("alertdialog", "Stopped", |text| {
        text.to_lowercase().contains("confirmed")
    })?;
    let drives = adapter.wire()?.since(pressed.sent_us).drives();
    let first = drives.frames.iter().find(|frame| frame.brakes());
    let first = first.context("no stop frame")?;
    Ok(first.at_us - pressed.sent_us)
}
