//! Measures the duration of a full scan.

use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use end_to_end::{
    Bench, Line, Page, Usb, View, WAIT_MAX,
    figures::{percentile, row},
    wait_until,
};

/// The motors on the bus: at both ends of the addresses and in the middle.
const MOTORS: [u8; 3] = [1, 42, 254];
/// Number of scans per kind of adapter.
const SCANS: usize = 5;

pub fn measure() -> Result<()> {
    scans(
        "on the bench",
        Line::with_motors(&MOTORS),
        Usb::CH340,
        2_500,
    )?;
    let held = Line::with_motors(&MOTORS).with(&["--latency-ms", "16"]);
    scans(
        "on an adapter that holds bytes for 16 ms",
        held,
        Usb::FTDI,
        7_000,
    )
}

fn scans(where_: &str, line: Line, chip: (u16, u16), most_ms: u64) -> Result<()> {
    let bench = Bench::start()?;
    let _adapter = bench.plug(line, Usb::of(chip))?;
    let page = bench.open("/")?;
    page.look(View::DESKTOP)?;
    page.click("button", "Connect motor")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.open_panel("ID Manager")?;
    let mut took = Vec::new();
    let mut found = Vec::new();
    for _ in 0..SCANS {
        took.push(scan(&page)?);
        found.push(motors_found(&page)?);
    }
    took.sort_unstable();
    let of_hundred = |percent| percentile(&took, percent).context("no scan");
    let (median, worst) = (of_hundred(50)?, of_hundred(100)?);
    let right = found.iter().filter(|found| **found == MOTORS).count();
    row(
        &format!("full scan, 254 addresses, three motors, {where_}, {SCANS} scans"),
        &format!(
            "all three, none invented, at most {} s",
            seconds(Duration::from_millis(most_ms))
        ),
        format!(
            "median {} s, worst {} s; all three and no other in {right} of {SCANS}",
            seconds(median),
            seconds(worst)
        ),
        right == SCANS && worst <= Duration::from_millis(most_ms),
    );
    crate::ensure_quiet(&page)
}

/// Time from the click to the end of the scan, when it can no longer be cancelled.
fn scan(page: &Page) -> Result<Duration> {
    // If several motors answered at once, a notice has such a button, too.
    let button = page.find_all("button", "Full scan")?.pop();
    let button = button.context("no button Full scan")?;
    ensure!(!button.disabled, "{}", button.description);
    let clicked = Instant::now();
    button.click()?;
    for running in [true, false] {
        wait_until("the scan to begin and end", WAIT_MAX, || {
            let cancel = page.find("button", "Cancel")?;
            Ok(if cancel.disabled == running {
                Err(cancel.description)
            } else {
                Ok(())
            })
        })?;
    }
    Ok(clicked.elapsed())
}

/// The IDs of the list of motors.
fn motors_found(page: &Page) -> Result<Vec<u8>> {
    let items = page.find("list", "Motors found")?.items()?;
    let id = |item: &String| {
        let hex = item.split("0x").nth(1)?.get(..2)?;
        u8::from_str_radix(hex, 16).ok()
    };
    Ok(items.iter().filter_map(id).collect())
}

fn seconds(time: Duration) -> String {
    format!("{:.2}", time.as_secs_f64())
}
