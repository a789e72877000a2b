//! A person drives a motor over real Web Serial, in every loop.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console, number, spin, spin_by, wait_for_speed,
    wait_for_wire,
};
use anyhow::{Context, Result};
use end_to_end::{Bench, Frame, Line, Usb, now_us, wait_until};

/// The main job.
#[test]
fn connect_press_plus_100_and_the_wheel_turns() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    assert!(page.text("status", "Connection")?.contains("1a86:7523"));
    scenario.stays_undriven(Duration::from_secs(1))?;

    let pressed = now_us();
    spin(page, "+100", 97..=103)?;
    page.wait_for_text("output", "Motion", |text| text.contains("Spinning CCW"))?;
    page.wait_for_text("output", "Temperature", |text| number(text).is_some())?;
    thread::sleep(Duration::from_secs(2));
    let drives = scenario.since(pressed)?.drives();
    assert!(
        drives
            .frames
            .iter()
            .all(|frame| frame.drive_setpoint() == Some(100))
    );
    assert!(drives.len() > 50, "{drives}");
    let title = page.evaluate("document.title")?;
    assert!(
        title.as_str().is_some_and(|title| title.contains("rpm")),
        "{title}"
    );

    let pressed = now_us();
    page.click("button", "-100")?;
    wait_for_speed(page, -103..=-97)?;
    page.wait_for_text("output", "Motion", |text| text.contains("Spinning CW"))?;
    assert!(
        scenario
            .since(pressed)?
            .drives()
            .frames
            .iter()
            .any(|f| f.drive_setpoint() == Some(-100))
    );

    let pressed = now_us();
    page.click("button", "Stop")?;
    wait_for_speed(page, 0..=0)?;
    page.wait_for_text("output", "Motion", |text| text.contains("Stationary"))?;
    assert_ends_braked(&scenario.since(pressed)?);
    scenario.stays_undriven(Duration::from_secs(1))?;

    page.click("button", "Disconnect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    let left = now_us();
    thread::sleep(Duration::from_millis(500));
    assert!(scenario.since(left)?.is_empty());
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn the_target_is_set_by_slider_and_field_and_kept_in_range() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.fill("spinbutton", "Target speed", "60")?;
    page.click("button", "Start")?;
    wait_for_speed(page, 57..=63)?;
    // A driven wheel follows the slider.
    page.slide("Target speed", -40.0)?;
    wait_for_speed(page, -43..=-37)?;
    // While it is typed, the wheel goes on as it did; what is out of range is refused where it was
    // typed, and nothing changes by it.
    let typed = now_us();
    page.fill("spinbutton", "Target speed", "400")?;
    page.press("Enter")?;
    let wire = wait_for_wire(&scenario, typed, "drive frames", |wire| {
        wire.drives().len() >= 20
    })?;
    let drives = wire.drives();
    assert!(
        drives
            .frames
            .iter()
            .all(|frame| frame.drive_setpoint() == Some(-40)),
        "{drives}"
    );
    assert!(
        page.find("spinbutton", "Target speed")?
            .description
            .contains("330")
    );
    page.press("Escape")?;
    wait_for_speed(page, 0..=0)?;
    // A drag that outlasts the stop does not start the wheel again.
    scenario.release()?;
    page.slide("Target speed", 80.0)?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn the_current_loop_drives_and_its_stop_lets_the_wheel_coast() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.click("tab", "Current")?;
    let pressed = now_us();
    page.click("button", "+0.5 A")?;
    wait_for_speed(page, 30..=250)?;
    let drives = scenario.since(pressed)?.drives();
    assert_eq!(drives.last().and_then(Frame::drive_setpoint), Some(2_048));
    let pressed = now_us();
    page.click("button", "Stop")?;
    thread::sleep(Duration::from_millis(300));
    let drives = scenario.since(pressed)?.drives();
    assert_eq!(drives.last().and_then(Frame::drive_setpoint), Some(0));
    // It coasts: after a second it still turns.
    thread::sleep(Duration::from_secs(1));
    assert!(number(&page.text("output", "Speed")?).is_some_and(|rpm| rpm > 10.0));
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn the_position_loop_goes_to_an_angle_and_stop_holds_it() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.click("tab", "Position")?;
    page.click("button", "90°")?;
    let at_90 = |text: &str| number(text).is_some_and(|angle| (angle - 90.0).abs() < 3.0);
    page.wait_for_text("output", "Position", at_90)?;
    page.click("button", "Stop")?;
    thread::sleep(Duration::from_secs(1));
    assert!(at_90(&page.text("output", "Position")?));
    assert_quiet_console(page);
    Ok(())
}

/// Two presses lead from 100 rpm to 90 degrees. The wheel stands before its loop is switched.
#[test]
fn a_start_in_another_loop_stops_switches_and_drives() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let page = &scenario.page;
    page.click("tab", "Position")?;
    let pressed = now_us();
    page.click("button", "90°")?;
    let at_90 = |text: &str| number(text).is_some_and(|angle| (angle - 90.0).abs() < 3.0);
    page.wait_for_text("output", "Mode", |text| {
        text.to_lowercase().contains("position")
    })?;
    page.wait_for_text("output", "Position", at_90)?;
    let wire = scenario.since(pressed)?;
    let first = |is_it: fn(&Frame) -> bool| wire.frames.iter().position(is_it);
    let braked = first(Frame::brakes).context("no brake")?;
    let switched = first(|frame| frame.bytes.starts_with(&[1, 0xA0])).context("no switch")?;
    let quarter = Some(8_192);
    let driven = wire
        .frames
        .iter()
        .position(|it| it.drive_setpoint() == quarter);
    let driven = driven.context("no drive")?;
    assert!(braked < switched && switched < driven, "{wire}");
    // What waits for a stop ends with the next one.
    page.click("tab", "Velocity")?;
    let pressed = now_us();
    page.click("button", "+50")?;
    page.click("button", "Stop")?;
    wait_for_speed(page, 0..=0)?;
    thread::sleep(Duration::from_secs(1));
    let wire = scenario.since(pressed)?;
    assert!(wire.drives().frames.iter().any(Frame::brakes), "{wire}");
    scenario.stays_undriven(Duration::from_secs(1))?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn letters_drive_and_stop() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    spin_by("press 1", page, 47..=53, || page.press("1"))?;
    page.press("b")?;
    wait_for_speed(page, -103..=-20)?;
    page.press("k")?;
    page.wait_for_text("output", "Motion", |text| {
        text.contains("Braking") || text.contains("Stationary")
    })?;
    wait_for_speed(page, 0..=0)?;
    let pressed = now_us();
    page.press("s")?;
    // The stop has frames of its own, also for a wheel that stands.
    wait_until("the last stop frame", Duration::from_secs(5), || {
        let newest = scenario.since(pressed)?.drives();
        let is_over = newest
            .last()
            .is_some_and(|frame| now_us().saturating_sub(frame.at_us) > 500_000);
        Ok(is_over.then_some(()).ok_or_else(|| newest.to_string()))
    })?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    // In a text field they are letters.
    page.find("spinbutton", "Target speed")?.focus()?;
    page.press("f")?;
    page.press("2")?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn one_motor_at_another_address_is_found_and_selected() -> Result<()> {
    let bench = Bench::reuse()?;
    let adapter = bench.plug(Line::with_motors(&[7]), Usb::default())?;
    let page = bench.open("/")?;
    crate::fixture::connect(&page)?;
    page.click("button", "+50")?;
    wait_for_speed(&page, 47..=53)?;
    assert!(
        adapter
            .wire()?
            .drives()
            .frames
            .iter()
            .all(|frame| frame.id() == Some(7))
    );
    assert_quiet_console(&page);
    Ok(())
}
