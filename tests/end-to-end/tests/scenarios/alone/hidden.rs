//! A page that is hidden for long, as behind another tab while a robot drives.

use std::{env, thread, time::Duration};

use crate::fixture::{Scenario, assert_quiet_console, rules::the_log_has_it_all, wait_for_speed};
use anyhow::Result;
use end_to_end::{Frame, now_us};

/// The rate is looked at in slices of this: a busy machine makes up for no more than a slice.
const SLICE: Duration = Duration::from_secs(5);

/// Drive frames a second at the 50 Hz setting. A hidden page's own timers would give one a second, and
/// after a minute one a minute; a machine with three browsers at once is given a fifth.
const LEAST_HZ: u64 = 40;

/// Drives at 50 Hz all along: in every slice on the wire, and by the command that was given.
fn drives_on_while_hidden(duration: Duration) -> Result<()> {
    let scenario = Scenario::spinning()?;
    scenario.bench.hide(&scenario.page)?;
    let hidden = now_us();
    thread::sleep(duration);
    let drives = scenario.since(hidden)?.drives();
    let asked = |frame: &Frame| frame.drive_setpoint() == Some(100);
    assert!(drives.frames.iter().all(asked), "{drives}");
    let slices = duration.as_secs() / SLICE.as_secs();
    for slice in 0..slices {
        let from = hidden + slice * SLICE.as_secs() * 1_000_000;
        let until = from + SLICE.as_secs() * 1_000_000;
        let count = drives.since(from).until(until).len() as u64;
        assert!(
            count >= LEAST_HZ * SLICE.as_secs(),
            "{count} drive frames in slice {slice} of {SLICE:?}"
        );
    }
    let longest = drives.gaps().unwrap();
    println!("{} frames, {longest:?}", drives.len());
    scenario.page.show()?;
    wait_for_speed(&scenario.page, 97..=103)?;
    assert!(scenario.page.find_all("alertdialog", "Stopped")?.is_empty());
    the_log_has_it_all(&scenario, 0)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// For 10 s, or as long as `cargo xtask reliability hidden` asks: five minutes.
#[test]
fn a_hidden_page_drives_at_50_hz_all_along() -> Result<()> {
    let seconds = match env::var("MOTORLINK_HIDDEN_SECONDS") {
        Ok(seconds) => seconds.parse()?,
        Err(_) => 10,
    };
    drives_on_while_hidden(Duration::from_secs(seconds))
}
