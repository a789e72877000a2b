//! Measures the jitter of command rates.

use std::time::Duration;

use anyhow::{Context, Result};
use end_to_end::{
    Bench, Line, WireLog,
    figures::{ms, percentile, ratio, row},
};

use crate::driving::{connected, spin, watch_both};

const HERTZ: u16 = 200;
const PERIOD_US: u64 = 5_000;

pub fn measure(watched: Duration) -> Result<()> {
    let bench = Bench::start()?;
    let (adapter, page) = connected(&bench, Line::default())?;
    spin(&page, HERTZ)?;
    for (page_is, wire) in watch_both(&bench, &adapter, &page, watched)? {
        rows(page_is, &wire)?;
    }
    crate::ensure_quiet(&page)
}

fn rows(page_is: &str, wire: &WireLog) -> Result<()> {
    let drives = wire.drives();
    let (first, last) = (
        drives.first().context("no drive frame")?.at_us,
        drives.last().context("no drive frame")?.at_us,
    );
    let hertz = ratio(1_000_000 * (drives.len() as u64 - 1), last - first);
    row(
        &format!("drive frames at the {HERTZ} Hz setting, page {page_is}"),
        "199 a second or more",
        format!("{hertz:.2} a second"),
        hertz >= 199.0,
    );
    let times: Vec<u64> = drives.frames.iter().map(|frame| frame.at_us).collect();
    let late = lateness(&times);
    let p99 = percentile(&late, 99).context("no drive frame")?;
    row(
        &format!("lateness against the schedule, p99, page {page_is}"),
        "at most 1 ms",
        ms(p99),
        p99 <= 1_000,
    );
    Ok(())
}

/// The lateness of each frame against an even schedule, sorted. In each second the schedule is aligned to its
/// earliest frame, because the clocks of browser and wire can drift.
fn lateness(times: &[u64]) -> Vec<u64> {
    let a_second = usize::from(HERTZ);
    let mut late: Vec<u64> = times
        .chunks(a_second)
        .flat_map(|second| {
            let due = |place: usize| place as u64 * PERIOD_US;
            // Lateness against a schedule that begins at zero.
            let offsets: Vec<u64> = second
                .iter()
                .enumerate()
                .map(|(place, at)| at.saturating_sub(due(place).min(*at)))
                .collect();
            let earliest = offsets.iter().min().copied().unwrap_or(0);
            offsets.into_iter().map(move |offset| offset - earliest)
        })
        .collect();
    late.sort_unstable();
    late
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_schedule_is_never_late_and_a_delay_is_seen() {
        let mut times: Vec<u64> = (0..400).map(|n| 1_000_000 + n * PERIOD_US).collect();
        assert_eq!(lateness(&times).last(), Some(&0));
        times[100] += 700;
        assert_eq!(lateness(&times).last(), Some(&700));
    }
}
