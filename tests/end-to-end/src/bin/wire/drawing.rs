//! Compares the processor time of a visible and a hidden page, thread by thread.

use std::{thread, time::Duration};

use anyhow::Result;
use end_to_end::{Bench, Line, figures::row_without_bound, threads_time};

use crate::{
    crowd,
    driving::{SETTLES, connected, spin},
};

const HERTZ: u16 = 50;

/// Names of Chromium's threads, truncated by the system, and their purpose.
const THREADS: [(&str, &str); 5] = [
    ("VizCompositorTh", "putting layers together"),
    ("chromium", "main threads of page and browser"),
    ("Compositor", "layers of the page"),
    ("ThreadPoolForeg", "painting"),
    ("DedicatedWorker", "both workers"),
];

pub fn measure(watched: Duration) -> Result<()> {
    for motors in [1, 4] {
        measure_with(motors, watched)?;
    }
    Ok(())
}

fn measure_with(motors: u8, watched: Duration) -> Result<()> {
    let bench = Bench::start()?;
    let (_adapter, page) = connected(&bench, Line::with_motors(&(1..=motors).collect::<Vec<_>>()))?;
    let driven = if motors == 1 {
        spin(&page, HERTZ)?;
        "one motor".to_owned()
    } else {
        // The command rate is 50 Hz unless somebody changes it.
        crowd::drive(&page, motors, motors)?;
        format!("{motors} motors together")
    };
    for page_is in ["visible", "hidden"] {
        if page_is == "hidden" {
            bench.hide(&page)?;
        }
        thread::sleep(SETTLES);
        let before = times()?;
        thread::sleep(watched);
        let after = times()?;
        let mut words = Vec::new();
        let mut total_ms = 0.0;
        for ((after, before), (_, what)) in after.iter().zip(before).zip(THREADS) {
            let spent = after.saturating_sub(before).as_secs_f64();
            let a_second_ms = 1_000.0 * spent / watched.as_secs_f64();
            total_ms += a_second_ms;
            words.push(format!("{what} {a_second_ms:.0}"));
        }
        row_without_bound(
            &format!("processor time of a second, {driven} at {HERTZ} Hz, page {page_is}"),
            format!("{total_ms:.0} ms: {}", words.join(", ")),
        );
    }
    crate::ensure_quiet(&page)
}

fn times() -> Result<Vec<Duration>> {
    THREADS.iter().map(|(name, _)| threads_time(name)).collect()
}
