//! Measures a rover with four wheels that the drive pad drives, with the rover on the screen.

use std::{thread, time::Duration};

use anyhow::Result;
use end_to_end::Bench;

use crate::{
    crowd::{held, line, scan},
    driving::{SETTLES, connected, has_digits, watch},
};

/// Motors 1 and 3 on the left, 2 and 4 on the right, as the browser stores them.
const FLEET: &str = "localStorage.setItem('motorlink.fleet', \
    '1\\tyes\\tleft\\t\\n2\\tyes\\tright\\t\\n3\\tyes\\tleft\\t\\n4\\tyes\\tright\\t\\n')";

/// The page is visible: hiding it ends the hold.
pub fn measure(watched: Duration) -> Result<()> {
    let bench = Bench::start()?;
    let (adapter, page) = connected(&bench, line(4))?;
    page.evaluate(FLEET)?;
    page.reload()?;
    page.click("button", "Connect motor")?;
    page.wait_for_text("output", "Speed", has_digits)?;
    scan(&page, 4)?;
    page.open_panel("Drive together")?;
    page.find_like("application", "Drive pad")?.focus()?;
    page.hold_key("ArrowUp")?;
    page.wait_for_text("output", "Forward", |text| text.starts_with('+'))?;
    thread::sleep(SETTLES);
    let wire = watch(&adapter, watched)?;
    page.release_key("ArrowUp")?;
    held(
        "rover with 4 wheels, driven by the pad, page visible",
        "50 Hz for each wheel, no gap over 30 ms",
        &wire,
        1..=4,
        watched,
    )?;
    crate::ensure_quiet(&page)
}
