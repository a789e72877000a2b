//! An adapter that stalls: it takes frames and puts none on the wire, then all of them.

use std::{thread, time::Duration};

use crate::fixture::{Scenario, assert_ends_braked, assert_quiet_console, spin, wait_for_speed};
use anyhow::Result;
use end_to_end::{Line, now_us};

/// How long it stalls, and how long the wire is watched after STOP.
const STALL_MS: u64 = 1_000;
const WATCHED: Duration = Duration::from_secs(2);

/// Drives, has the adapter stall, and presses STOP so long after. Gives how many drive frames that are
/// no stop went over the wire after STOP was pressed.
fn stale_drive_frames(scenario: &mut Scenario, press_after: Duration) -> Result<usize> {
    spin(&scenario.page, "+100", 97..=103)?;
    scenario.adapter.act(&format!("stall {STALL_MS}"))?;
    thread::sleep(press_after);
    let pressed = now_us();
    scenario.page.press("Escape")?;
    thread::sleep(WATCHED);
    let wire = scenario.since(pressed)?;
    let stale = wire.drives().frames.iter().filter(|f| !f.is_stop()).count();
    let waited = wire.from_host().until(pressed + STALL_MS * 1_100).len();
    println!(
        "STOP {press_after:?} into the stall: {stale} drive frames, {waited} frames behind it"
    );
    assert_ends_braked(&wire);
    wait_for_speed(&scenario.page, 0..=0)?;
    scenario.page.click("button", "Release")?;
    Ok(stale)
}

#[test]
fn behind_an_adapter_that_stalls_no_drive_frame_waits_but_the_one_in_flight() -> Result<()> {
    let mut scenario = Scenario::connected(Line::default())?;
    scenario.page.fill("spinbutton", "Command rate", "500")?;
    for millis in [50, 150, 500] {
        let stale = stale_drive_frames(&mut scenario, Duration::from_millis(millis))?;
        assert!(stale <= 1, "{stale} drive frames were older than the stop");
    }
    assert_quiet_console(&scenario.page);
    Ok(())
}
