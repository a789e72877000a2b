//! Setting up the wheels of a rover, one motor after the other.

use std::time::Duration;

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console, connect, wait_until_enabled,
};
use anyhow::Result;
use end_to_end::{Frame, Line, Page, WAIT_MAX, now_us, retry, wait_until};

/// The same bound as in the scenarios of scans: on a busy machine replies are late.
const SCAN_MAX: Duration = Duration::from_secs(120);

/// Reloads the page, connects again and opens the panel.
fn reopen(page: &Page) -> Result<()> {
    page.reload()?;
    connect(page)?;
    open(page)
}

fn open(page: &Page) -> Result<()> {
    page.open_panel("ID Manager")?;
    page.click("button", "ID wizard")
}

fn said(page: &Page, wanted: &str) -> Result<()> {
    page.wait_for_text_within(SCAN_MAX, "status", "Wheel setup", |text| {
        text.contains(wanted)
    })?;
    Ok(())
}

#[test]
fn a_setup_continues_after_reloads_and_a_spin_lasts_half_a_second() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    open(page)?;
    page.click("button", "2 wheels")?;
    // The next button moves up when a row disappears.
    wait_until("two rows", WAIT_MAX, || {
        let third = page.find_all("textbox", "Name of wheel 3")?;
        Ok(third
            .is_empty()
            .then_some(())
            .ok_or("three rows".to_owned()))
    })?;
    page.fill("textbox", "ID of wheel 2", "5")?;
    page.click("button", "Set the IDs")?;
    page.click("button", "Skip this wheel")?;
    said(page, "Connect only the motor of Right wheel")?;

    reopen(page)?;
    said(page, "Connect only the motor of Right wheel")?;
    // A busy machine may lose a reply: the page says so, and the user presses the button again.
    retry("set the ID", 3, || {
        page.click("button", "Find and set ID")?;
        page.wait_for_text_within(SCAN_MAX, "alertdialog", "Change the ID?", |text| {
            text.contains("0x01 becomes 0x05")
        })?;
        page.click("button", "Set ID 0x05")?;
        let ended = |text: &str| text.contains("now has ID") || text.contains("not changed");
        let said = page.wait_for_text_within(SCAN_MAX, "status", "Wheel setup", ended)?;
        Ok(if said.contains("Motor 0x01 now has ID 0x05") {
            Ok(())
        } else {
            Err(said)
        })
    })?;

    reopen(page)?;
    said(page, "Right wheel has ID 0x05")?;
    page.click("button", "Labelled: check all")?;
    page.click("button", "Check all")?;
    said(page, "No reply from Left wheel (0x01)")?;
    page.click("button", "Continue")?;
    said(page, "spin each wheel")?;
    // The page forgets the silent motor 0x01 first.
    wait_until_enabled(page, "button", "Spin Right wheel", true)?;
    let pressed = now_us();
    page.click("button", "Spin Right wheel")?;
    said(page, "What did you see?")?;
    let wire = scenario.since(pressed)?.of_motor(5);
    let drives = wire.drives();
    let turns = |frame: &&Frame| !frame.is_stop();
    let turning: Vec<&Frame> = drives.frames.iter().filter(turns).collect();
    let forward = |frame: &&Frame| frame.drive_setpoint() == Some(-20);
    assert!(turning.iter().all(forward), "{drives}");
    let lasted_us = turning[turning.len() - 1].at_us - turning[0].at_us;
    // The page's timer may be late on a busy machine, and the frames are 20 ms apart.
    assert!((400_000..900_000).contains(&lasted_us), "{lasted_us} us");
    assert_ends_braked(&wire);
    scenario.stays_undriven(Duration::from_millis(500))?;
    page.click("button", "Correct wheel, correct direction")?;
    page.click("button", "Finish")?;
    said(page, "2 wheels are set up")?;
    page.click("button", "Drive the wheels together")?;
    assert_eq!(page.find("textbox", "Name of 0x05")?.value, "Right wheel");
    assert_quiet_console(page);
    Ok(())
}
