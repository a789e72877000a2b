//! Motors that are driven as one, over real Web Serial.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console, open_name, stop_and_release, wait_for_wire,
};
use anyhow::{Context, Result};
use end_to_end::{Frame, Line, Page, now_us};

/// A rover: its left wheel is motor 1, its right wheel motor 2.
fn rover() -> Result<Scenario> {
    let scenario = Scenario::connected(Line::with_motors(&[1, 2]))?;
    let page = &scenario.page;
    page.open_panel("ID Manager")?;
    let scan = page.find_all("button", "Full scan")?.pop();
    scan.context("no button Full scan")?.click()?;
    page.wait_for_text("status", "Scan result", |text| text.contains("2 motors"))?;
    page.open_panel("Drive together")?;
    for id in 1..=2 {
        page.click("checkbox", &format!("Drive 0x{id:02X}"))?;
    }
    page.choose("Side of 0x01", "left")?;
    page.choose("Side of 0x02", "right")?;
    page.fill("spinbutton", "Group speed", "80")?;
    page.press("Enter")?;
    Ok(scenario)
}

/// The setpoints of these motors' last drive frames.
fn setpoints(scenario: &Scenario, since_us: u64) -> Result<[Option<i16>; 2]> {
    let wire = scenario.since(since_us)?;
    Ok([1, 2].map(|id| {
        let drives = wire.of_motor(id).drives();
        drives.last().and_then(Frame::drive_setpoint)
    }))
}

fn wait_for_setpoints(scenario: &Scenario, since_us: u64, wanted: [i16; 2]) -> Result<()> {
    wait_for_wire(scenario, since_us, &format!("{wanted:?} rpm"), |wire| {
        [1, 2].iter().zip(wanted).all(|(id, wanted)| {
            let drives = wire.of_motor(*id).drives();
            drives.last().and_then(Frame::drive_setpoint) == Some(wanted)
        })
    })?;
    Ok(())
}

fn assert_both_braked(scenario: &Scenario, since_us: u64) -> Result<()> {
    thread::sleep(Duration::from_millis(800));
    let wire = scenario.since(since_us)?;
    for id in 1..=2 {
        assert_ends_braked(&wire.of_motor(id));
    }
    scenario.stays_undriven(Duration::from_secs(1))
}

#[test]
fn two_wheels_start_and_stop_as_one_and_the_right_one_is_mirrored() -> Result<()> {
    let scenario = rover()?;
    let page = &scenario.page;
    let pressed = now_us();
    page.click("button", "Start group")?;
    wait_for_setpoints(&scenario, pressed, [80, -80])?;
    let pressed = now_us();
    page.click("button", "Stop group")?;
    assert_both_braked(&scenario, pressed)?;
    assert_quiet_console(page);
    Ok(())
}

/// It would turn the rover on the spot.
#[test]
fn no_key_turns_one_wheel_of_a_chosen_group() -> Result<()> {
    let scenario = rover()?;
    let page = &scenario.page;
    page.find("button", "Start group")?.focus()?;
    for key in ["f", "b", "3"] {
        page.press(key)?;
    }
    scenario.stays_undriven(Duration::from_secs(1))?;
    page.click("radio", "Motor")?;
    let pressed = now_us();
    page.press("f")?;
    wait_for_wire(&scenario, pressed, "100 rpm", |wire| {
        let drives = wire.drives();
        drives.last().and_then(Frame::drive_setpoint) == Some(100)
    })?;
    page.press("Escape")?;
    assert_quiet_console(page);
    Ok(())
}

/// One motor is driven in the current loop. It stops first, and then both start.
#[test]
fn a_group_starts_from_another_loop() -> Result<()> {
    let scenario = rover()?;
    let page = &scenario.page;
    page.click("radio", "Motor")?;
    page.click("tab", "Current")?;
    page.fill("spinbutton", "Target current", "0.5")?;
    page.click("button", "Start")?;
    page.wait_for_text("status", "Mode", |text| text.contains("Current loop"))?;
    page.click("radio", "Group")?;
    let pressed = now_us();
    page.click("button", "Start group")?;
    wait_for_setpoints(&scenario, pressed, [80, -80])?;
    let drives = scenario.since(pressed)?.of_motor(1).drives();
    let first_brake = drives.frames.iter().position(Frame::brakes);
    let first_drive = drives
        .frames
        .iter()
        .position(|frame| frame.drive_setpoint() == Some(80));
    assert!(
        first_brake.is_some() && first_brake < first_drive,
        "{drives}"
    );
    page.wait_for_text("status", "Mode", |text| text.contains("Velocity loop"))?;
    let pressed = now_us();
    page.click("button", "Stop group")?;
    assert_both_braked(&scenario, pressed)?;
    assert_quiet_console(page);
    Ok(())
}

/// Driven alone, the right wheel is counted as it is in the group: forward is +, and the wheel that is
/// seen turns as it does.
#[test]
fn a_mirrored_wheel_is_asked_and_read_with_the_other_sign() -> Result<()> {
    let scenario = Scenario::connected(Line::with_motors(&[1]))?;
    let page = &scenario.page;
    open_name(page)?;
    page.click("radio", "right, mirrored")?;
    page.click("button", "Save")?;
    let pressed = now_us();
    page.click("button", "+100")?;
    wait_for_wire(&scenario, pressed, "-100 rpm", |wire| {
        let drives = wire.of_motor(1).drives();
        drives.last().and_then(Frame::drive_setpoint) == Some(-100)
    })?;
    page.wait_for_text("status", "Speed", |text| {
        text.contains("+100") && text.contains("mirrored")
    })?;
    page.wait_for_text("status", "Motion", |text| text == "Spinning CW")?;
    let drives = scenario.since(pressed)?.of_motor(1).drives();
    let sent = drives.frames.iter().map(Frame::drive_setpoint);
    let sent: Vec<Option<i16>> = sent.collect();
    assert!(sent.iter().all(|rpm| *rpm == Some(-100)), "{sent:?}");

    // While it is driven, its side stays.
    open_name(page)?;
    assert!(page.find("radio", "right, mirrored")?.disabled);
    let stopped = now_us();
    page.press("Escape")?;
    thread::sleep(Duration::from_millis(800));
    assert_ends_braked(&scenario.since(stopped)?.of_motor(1));
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn when_one_wheel_loses_power_the_other_stops() -> Result<()> {
    let mut scenario = rover()?;
    let pressed = now_us();
    scenario.page.click("button", "Start group")?;
    wait_for_setpoints(&scenario, pressed, [80, -80])?;
    let cut = now_us();
    scenario.adapter.act("power 2 off")?;
    thread::sleep(Duration::from_secs(1));
    let wire = scenario.since(cut)?;
    assert_ends_braked(&wire.of_motor(1));
    let driven = wire.of_motor(1).drives();
    let last = driven.frames.iter().rfind(|frame| !frame.brakes());
    let after = last.map_or(0, |frame| frame.at_us - cut);
    assert!(after < 600_000, "driven for {after} us more");
    Ok(())
}

#[test]
fn the_pad_drives_while_a_key_is_held_and_no_longer() -> Result<()> {
    let scenario = rover()?;
    let page = &scenario.page;
    pad(page)?;
    let pressed = now_us();
    page.hold_key("ArrowUp")?;
    wait_for_setpoints(&scenario, pressed, [80, -80])?;
    thread::sleep(Duration::from_millis(500));
    let released = now_us();
    page.release_key("ArrowUp")?;
    assert_both_braked(&scenario, released)?;

    // A pad that is held while all is stopped starts nothing.
    pad(page)?;
    let pressed = now_us();
    page.hold_key("ArrowUp")?;
    wait_for_setpoints(&scenario, pressed, [80, -80])?;
    let stopped = now_us();
    stop_and_release(page)?;
    page.release_key("ArrowUp")?;
    assert_both_braked(&scenario, stopped)?;
    assert_eq!(setpoints(&scenario, stopped)?, [Some(0), Some(0)]);
    Ok(())
}

/// Gives the pad the focus.
fn pad(page: &Page) -> Result<()> {
    let pad = page.find_like("application", "Drive pad")?;
    pad.focus()
}
