//! Measures what a stalled adapter sends after a stop.

use std::{thread, time::Duration};

use anyhow::Result;
use end_to_end::{Bench, Line, figures::row, now_us};

use crate::driving::{connected, spin};

/// Duration of the stall, and of the measurement after STOP.
const STALL_MS: u64 = 1_000;
const WATCHED: Duration = Duration::from_secs(2);
/// When STOP is pressed: before the motor counts as silent and after.
const PRESSED_AFTER_MS: [u64; 4] = [20, 100, 180, 500];

pub fn measure() -> Result<()> {
    let mut worst = 0;
    for millis in PRESSED_AFTER_MS {
        worst = worst.max(stale_frames(Duration::from_millis(millis))?);
    }
    row(
        "drive frames older than a stop that go over the wire behind it, adapter stalled for 1 s at 500 Hz",
        "the one in flight",
        worst,
        worst <= 1,
    );
    Ok(())
}

fn stale_frames(press_after: Duration) -> Result<usize> {
    let bench = Bench::start()?;
    let (mut adapter, page) = connected(&bench, Line::default())?;
    spin(&page, 500)?;
    adapter.act(&format!("stall {STALL_MS}"))?;
    thread::sleep(press_after);
    let pressed_us = now_us();
    page.press("Escape")?;
    thread::sleep(WATCHED);
    let drives = adapter.wire()?.since(pressed_us).drives();
    crate::ensure_quiet(&page)?;
    Ok(drives.frames.iter().filter(|f| !f.is_stop()).count())
}
