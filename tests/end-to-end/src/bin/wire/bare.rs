//! Compares the exchange rate of the page with a bare loop that does nothing else.

use std::{path::Path, time::Duration};

use anyhow::Result;
use end_to_end::{
    Bench, Line, Usb, WireLog,
    figures::{ratio, row},
};

use crate::driving::{connected, spin, watch, watch_both};

/// Minimal part of the bare loop's rate that the page must reach.
const RATIO_MIN: f64 = 0.97;
/// Turnarounds in microseconds: the default one, and the shortest.
const TURNAROUNDS_US: [u32; 2] = [600, 100];

pub fn measure(watched: Duration) -> Result<()> {
    for turnaround_us in TURNAROUNDS_US {
        let line = || Line {
            turnaround_us,
            ..Line::default()
        };
        let of = format!("at the 500 Hz setting, one motor, {turnaround_us} us turnaround");
        against_a_bare_loop(line, 115_200, &of, watched)?;
    }
    Ok(())
}

/// Measures a bare loop, the visible page and the hidden page on lines of the same kind.
pub fn against_a_bare_loop(
    line: impl Fn() -> Line,
    baud: u32,
    of: &str,
    watched: Duration,
) -> Result<()> {
    // Alternating, so that a machine that becomes slower favours neither.
    let part = watched / 2;
    let (mut bare, mut visible, mut hidden) = (0, 0, 0);
    for _ in 0..2 {
        bare += bare_exchanges(line(), baud, part)?;
        let (seen, unseen) = page_exchanges(line(), part)?;
        visible += seen;
        hidden += unseen;
    }
    let seconds = watched.as_secs().max(1);
    for (page_is, page) in [("visible", visible), ("hidden", hidden)] {
        let share = ratio(page, bare);
        row(
            &format!("exchanges a second {of}, against a bare loop, page {page_is}"),
            &format!("{RATIO_MIN} or more"),
            format!(
                "{share:.3} ({} of {} a second)",
                page / seconds,
                bare / seconds
            ),
            share >= RATIO_MIN,
        );
    }
    Ok(())
}

fn bare_exchanges(line: Line, baud: u32, watched: Duration) -> Result<u64> {
    let fixtures = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures"));
    let bench = Bench::serving(fixtures)?;
    let adapter = bench.plug(line, Usb::default())?;
    let page = bench.open(&format!("/bare.html?baud={baud}"))?;
    page.wait_for_text("output", "Port of the loop", |text| text == "open")?;
    Ok(watch(&adapter, watched)?.from_motors().len() as u64)
}

/// Exchanges of the page while it is visible, and while it is hidden.
fn page_exchanges(line: Line, watched: Duration) -> Result<(u64, u64)> {
    let bench = Bench::start()?;
    let (adapter, page) = connected(&bench, line)?;
    spin(&page, 500)?;
    let [visible, hidden] = watch_both(&bench, &adapter, &page, watched)?;
    crate::ensure_quiet(&page)?;
    let exchanges = |(_, wire): (_, WireLog)| wire.from_motors().len() as u64;
    Ok((exchanges(visible), exchanges(hidden)))
}
