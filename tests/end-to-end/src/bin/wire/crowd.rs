//! Measures many motors on one bus, and one that stops answering.

use std::{ops::RangeInclusive, time::Duration};

use anyhow::{Context, Result};
use end_to_end::{
    Bench, Line, Page, WireLog,
    figures::{ms, ratio, row},
};

use crate::driving::{connected, has_digits, watch, watch_both};

/// Turnaround, shorter than in the other measurements, as the issue requires.
const TURNAROUND_US: u32 = 200;
const GAP_MAX_US: u64 = 30_000;

pub fn measure(watched: Duration) -> Result<()> {
    six(watched)?;
    twelve(watched)?;
    silent(watched)
}

pub fn line(motors: u8) -> Line {
    let ids: Vec<u8> = (1..=motors).collect();
    Line {
        turnaround_us: TURNAROUND_US,
        ..Line::with_motors(&ids)
    }
}

/// Scans until `found` motors are known.
pub fn scan(page: &Page, found: u8) -> Result<()> {
    page.open_panel("ID Manager")?;
    // If several motors answered at once, a notice has such a button, too.
    let scan = page.find_all("button", "Full scan")?.pop();
    scan.context("no button Full scan")?.click()?;
    page.wait_for_text("status", "Scan result", |text| {
        text.contains(&format!("{found} motors"))
    })?;
    Ok(())
}

/// Scans for `found` motors and drives the first `driven` of them together.
pub fn drive(page: &Page, found: u8, driven: u8) -> Result<()> {
    scan(page, found)?;
    page.open_panel("Drive together")?;
    for id in 1..=driven {
        page.click("checkbox", &format!("Drive 0x{id:02X}"))?;
    }
    page.fill("spinbutton", "Group speed", "100")?;
    page.press("Enter")?;
    page.click("button", "Start group")?;
    page.wait_for_text("output", "Speed", has_digits)?;
    Ok(())
}

fn gaps_of(wire: &WireLog, id: u8) -> Result<(usize, u64)> {
    let drives = wire.of_motor(id).drives();
    let gaps = drives.gaps().context("no drive frames")?;
    Ok((drives.len(), gaps.max_us))
}

fn six(watched: Duration) -> Result<()> {
    let bench = Bench::start()?;
    let (adapter, page) = connected(&bench, line(6))?;
    drive(&page, 6, 6)?;
    for (page_is, wire) in watch_both(&bench, &adapter, &page, watched)? {
        held(
            &format!("6 motors at 50 Hz each with 5 Hz queries each, page {page_is}"),
            "all six held for 60 s, no gap over 30 ms",
            &wire,
            1..=6,
            watched,
        )?;
    }
    crate::ensure_quiet(&page)
}

/// Prints a row with the result whether each of these motors is driven at 50 Hz.
pub fn held(
    figure: &str,
    must: &str,
    wire: &WireLog,
    ids: RangeInclusive<u8>,
    watched: Duration,
) -> Result<()> {
    let mut least = u64::MAX;
    let mut longest = 0;
    for id in ids {
        let (frames, gap) = gaps_of(wire, id)?;
        least = least.min(frames as u64);
        longest = longest.max(gap);
    }
    let hertz = ratio(least, watched.as_secs().max(1));
    row(
        figure,
        must,
        format!("{hertz:.1} Hz or more each, longest gap {}", ms(longest)),
        hertz >= 49.5 && longest <= GAP_MAX_US,
    );
    Ok(())
}

fn twelve(watched: Duration) -> Result<()> {
    let bench = Bench::start()?;
    let (adapter, page) = connected(&bench, line(12))?;
    drive(&page, 12, 12)?;
    let wire = watch(&adapter, watched)?;
    page.open_panel("Link health")?;
    let said = page.text("output", "Bus capacity")?;
    let mut shares = Vec::new();
    for id in 1..=12 {
        shares.push(wire.of_motor(id).drives().len() as u64);
    }
    let (least, most) = (
        shares.iter().min().copied().context("no motor")?,
        shares.iter().max().copied().context("no motor")?,
    );
    let fair = ratio(least, most);
    row(
        "12 motors, more than the line carries",
        "the page says so; every motor gets its share within 5 %",
        format!("{said:?}; the least share is {fair:.3} of the greatest"),
        fair >= 0.95 && has_digits(&said),
    );
    crate::ensure_quiet(&page)
}

fn silent(watched: Duration) -> Result<()> {
    let bench = Bench::start()?;
    let (mut adapter, page) = connected(&bench, line(4))?;
    // A group would be stopped as a whole, so the fourth motor is only queried.
    drive(&page, 4, 3)?;
    adapter.act("power 4 off")?;
    for (page_is, wire) in watch_both(&bench, &adapter, &page, watched)? {
        held(
            &format!("one of 4 motors goes silent, page {page_is}"),
            "the other three keep 50 Hz, no gap over 30 ms",
            &wire,
            1..=3,
            watched,
        )?;
    }
    crate::ensure_quiet(&page)
}
