//! Measures what differs between models: how soon the page knows the model, how soon a wheel stands after a stop, and
//! the exchange rate at 38400 baud.

use std::{thread, time::Duration};

use anyhow::{Context, Result};
use end_to_end::{
    Bench, Line, Usb, View,
    figures::{ms, row},
    now_us,
};

use crate::{bare::against_a_bare_loop, driving::press_plus_100};

/// Each model with its baud rate. The preset +100 is about the rated speed of each: 98 to 115 rpm.
const MODELS: [(&str, u32); 4] = [
    ("ddsm115", 115_200),
    ("ddsm315", 115_200),
    ("ddsm210", 115_200),
    ("ddsm400", 38_400),
];
const KNOWN_MAX_US: [(u32, u64); 2] = [(115_200, 600_000), (38_400, 1_200_000)];
const STANDING_MAX_US: u64 = 400_000;
const TIMES: usize = 5;

pub fn measure(watched: Duration) -> Result<()> {
    for (model, baud) in MODELS {
        let mut known = Vec::new();
        let mut stopped = Vec::new();
        for _ in 0..TIMES {
            let (known_us, stopped_us) = connect_and_stop(model)?;
            known.push(known_us);
            stopped.push(stopped_us);
        }
        let longest = |times: &[u64]| times.iter().copied().max().unwrap_or(u64::MAX);
        let bound = KNOWN_MAX_US.iter().find(|(of, _)| *of == baud);
        let (_, known_max_us) = bound.context("no bound for this baud rate")?;
        row(
            &format!("{model}: from Connect to the model known, longest of {TIMES}"),
            &format!("under {}", ms(*known_max_us)),
            ms(longest(&known)),
            longest(&known) < *known_max_us,
        );
        row(
            &format!(
                "{model}: wheel standing and confirmed after a stop from 100 rpm, longest of {TIMES}"
            ),
            "at most 400 ms",
            ms(longest(&stopped)),
            longest(&stopped) <= STANDING_MAX_US,
        );
    }
    let line = || Line::default().with(&["--model", "ddsm400"]);
    against_a_bare_loop(line, 38_400, "of a ddsm400 at 38400 baud", watched)
}

/// Time from Connect to the first query after the model is known, and from a stop to its confirmation.
fn connect_and_stop(model: &str) -> Result<(u64, u64)> {
    let bench = Bench::start()?;
    let adapter = bench.plug(Line::default().with(&["--model", model]), Usb::default())?;
    let page = bench.open("/")?;
    page.look(View::DESKTOP)?;
    let pressed = now_us();
    page.click("button", "Connect motor")?;
    page.wait_for_text("status", "Connection", |text| text.contains("1a86:7523"))?;
    let known_us = now_us() - pressed;
    page.wait_for_text("output", "Speed", crate::driving::has_digits)?;
    press_plus_100(&page)?;
    page.wait_for_text("output", "Speed", |text| text.contains("100"))?;
    thread::sleep(Duration::from_secs(1));
    let key = page.press_timed("Escape")?;
    page.wait_for_text("alertdialog", "Stopped", |text| {
        text.to_lowercase().contains("confirmed")
    })?;
    let brakes = adapter.wire()?.since(key.sent_us).drives();
    let last = brakes.frames.iter().rfind(|frame| frame.brakes());
    let last = last.context("no stop frame")?;
    crate::ensure_quiet(&page)?;
    Ok((known_us, last.at_us.saturating_sub(key.sent_us)))
}
