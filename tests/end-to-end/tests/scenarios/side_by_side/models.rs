//! The siblings of the DDSM115, each on its own line: found by the page, driven and stopped in each loop, given
//! another ID, and kept within limits.

use std::time::Duration;

use crate::fixture::{
    Scenario, assert_quiet_console, open_panel, wait_for_speed, wait_for_wire, wait_until_enabled,
};
use anyhow::Result;
use end_to_end::{Frame, Line, Page, WAIT_MAX, WireLog, now_us, wait_until};

const SCAN_MAX: Duration = Duration::from_secs(60);

/// The page has found the model, and the motor answers.
fn found(model: &str, shown: &str) -> Result<Scenario> {
    let scenario = Scenario::connected(Line::default().with(&["--model", model]))?;
    let page = &scenario.page;
    page.wait_for_text("combobox", "Model", |text| text.contains(shown))?;
    scenario.stays_undriven(Duration::from_millis(500))?;
    Ok(scenario)
}

/// Opens the tab of this loop and switches the motor to it.
fn switched(page: &Page, tab: &str, to: &str) -> Result<()> {
    page.click("tab", tab)?;
    if !page.find_all("button", to)?.is_empty() {
        wait_until_enabled(page, "button", to, true)?;
        page.click("button", to)?;
    }
    let start = if tab == "Position" { "Go" } else { "Start" };
    wait_until_enabled(page, "button", start, true)
}

/// Presses Start, waits until the wheel turns by the true speed of the virtual motor, and stops it.
fn turned_and_stopped(scenario: &mut Scenario) -> Result<()> {
    let page = &scenario.page;
    let started = now_us();
    let start = if page.find_all("button", "Start")?.is_empty() {
        "Go"
    } else {
        "Start"
    };
    page.click("button", start)?;
    let drives = |wire: &WireLog| wire.drives().len() >= 5;
    wait_for_wire(scenario, started, "drive frames", drives)?;
    let stopped = now_us();
    // Space stops from each loop.
    page.press("Escape")?;
    page.wait_for_text("alertdialog", "Stopped", |text| {
        text.to_lowercase().contains("confirmed")
    })?;
    let braked = scenario.since(stopped)?.drives();
    assert!(braked.frames.iter().any(Frame::brakes), "{braked}");
    page.click("button", "Release")?;
    wait_for_speed(page, 0..=0)
}

/// Drives in the velocity loop at +50 rpm; the frames are in the unit of the model.
fn velocity(scenario: &mut Scenario, raw: i16) -> Result<()> {
    let page = &scenario.page;
    page.click("tab", "Velocity")?;
    wait_until_enabled(page, "button", "+50", true)?;
    let pressed = now_us();
    page.click("button", "+50")?;
    wait_for_speed(page, 48..=52)?;
    let drives = scenario.since(pressed)?.drives();
    let setpoints = || drives.frames.iter().filter_map(Frame::drive_setpoint);
    assert!(setpoints().any(|setpoint| setpoint == raw), "{drives}");
    assert!(setpoints().all(|setpoint| setpoint <= raw), "{drives}");
    page.wait_for_text("output", "Temperature", |text| {
        text.contains(|c: char| c.is_ascii_digit())
    })?;
    page.click("button", "Stop")?;
    wait_for_speed(page, 0..=0)
}

/// A lowered speed limit stops a faster wheel.
fn limited(scenario: &mut Scenario) -> Result<()> {
    let page = &scenario.page;
    // A stop leaves the motor in the velocity loop.
    page.click("tab", "Velocity")?;
    wait_until_enabled(page, "button", "+50", true)?;
    page.click("button", "+50")?;
    wait_for_speed(page, 48..=52)?;
    open_panel(page, "Settings")?;
    page.fill("spinbutton", "Speed limit", "30")?;
    page.wait_for_text("region", "Notices", |text| {
        text.contains("above your limit of 30 rpm")
    })?;
    wait_for_speed(page, 0..=0)?;
    page.fill("spinbutton", "Speed limit", "200")?;
    page.press("Escape")
}

/// A scan finds the motor, and it takes another ID.
fn given_an_id(scenario: &Scenario) -> Result<()> {
    let page = &scenario.page;
    page.click("tab", "ID Manager")?;
    page.fill("spinbutton", "New ID", "5")?;
    page.click("button", "Set ID")?;
    wait_until("the question for the ID", SCAN_MAX, || {
        let question = page.find_all("alertdialog", "Change the ID?")?.pop();
        Ok(question
            .map(drop)
            .ok_or_else(|| "no question yet".to_owned()))
    })?;
    page.click("button", "Set ID 0x05")?;
    page.wait_for_text("status", "Scan result", |text| {
        text.contains("now has ID 0x05")
    })?;
    Ok(())
}

#[test]
fn a_ddsm210_is_found_driven_in_each_loop_stopped_limited_and_given_an_id() -> Result<()> {
    let mut scenario = found("ddsm210", "DDSM210")?;
    assert!(scenario.page.find_all("tab", "Current")?.is_empty());
    velocity(&mut scenario, 500)?;
    switched(&scenario.page, "Open loop", "Switch to open loop")?;
    scenario.page.fill("spinbutton", "Target output", "20")?;
    turned_and_stopped(&mut scenario)?;
    switched(&scenario.page, "Position", "Switch to position loop")?;
    turned_and_stopped(&mut scenario)?;
    limited(&mut scenario)?;
    given_an_id(&scenario)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

#[test]
fn a_ddsm400_is_found_enabled_driven_in_each_loop_stopped_limited_and_given_an_id() -> Result<()> {
    let mut scenario = found("ddsm400", "DDSM400")?;
    velocity(&mut scenario, 500)?;
    switched(&scenario.page, "Open loop", "Switch to open loop")?;
    scenario.page.fill("spinbutton", "Target output", "20")?;
    turned_and_stopped(&mut scenario)?;
    switched(&scenario.page, "Current", "Switch to current loop")?;
    turned_and_stopped(&mut scenario)?;
    switched(&scenario.page, "Position", "Switch to position loop")?;
    turned_and_stopped(&mut scenario)?;
    limited(&mut scenario)?;
    given_an_id(&scenario)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// Its frames are those of a DDSM115: the person chooses it.
#[test]
fn a_ddsm315_is_chosen_driven_in_each_loop_stopped_limited_and_given_an_id() -> Result<()> {
    let mut scenario = found("ddsm315", "DDSM115")?;
    scenario.page.choose("Model", "DDSM315 / M0602C")?;
    wait_until("the motor to answer as a DDSM315", WAIT_MAX, || {
        Ok(if scenario.page.find("button", "+50")?.disabled {
            Err("+50 is disabled".to_owned())
        } else {
            Ok(())
        })
    })?;
    velocity(&mut scenario, 50)?;
    switched(&scenario.page, "Current", "Switch to current loop")?;
    turned_and_stopped(&mut scenario)?;
    switched(&scenario.page, "Position", "Switch to position loop")?;
    turned_and_stopped(&mut scenario)?;
    limited(&mut scenario)?;
    given_an_id(&scenario)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}
