//! The command rate, up to what the motor takes: 500 Hz.

use std::{thread, time::Duration};

use crate::fixture::{Scenario, assert_quiet_console, spin, wait_for_speed};
use anyhow::Result;
use end_to_end::{Bench, Line, Page, now_us};

/// Several times as long as a page may leave its worker without an answer.
const LONG: Duration = Duration::from_secs(6);

fn drive_at_500_hz(page: &Page) -> Result<()> {
    page.fill("spinbutton", "Command rate", "500")?;
    page.press("Enter")?;
    spin(page, "+100", 97..=103)
}

/// The worker that drives so fast still gets to the page's answers.
#[test]
fn the_virtual_motor_is_driven_at_500_hz_until_it_is_stopped() -> Result<()> {
    let bench = Bench::start()?;
    let page = bench.open("/?port=virtual")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    drive_at_500_hz(&page)?;
    thread::sleep(LONG);
    assert!(page.find_all("alertdialog", "Stopped")?.is_empty());
    wait_for_speed(&page, 97..=103)?;
    page.press("Escape")?;
    wait_for_speed(&page, 0..=0)?;
    assert_quiet_console(&page);
    Ok(())
}

#[test]
fn a_motor_on_the_wire_is_driven_at_500_hz_until_it_is_stopped() -> Result<()> {
    let scenario = Scenario::connected(Line {
        turnaround_us: 100,
        ..Line::default()
    })?;
    let page = &scenario.page;
    drive_at_500_hz(page)?;
    let from_us = now_us();
    thread::sleep(LONG);
    assert!(page.find_all("alertdialog", "Stopped")?.is_empty());
    let drives = scenario.since(from_us)?.drives();
    assert!(
        drives
            .frames
            .iter()
            .all(|frame| frame.drive_setpoint() == Some(100)),
        "{drives}"
    );
    let a_second = drives.len() as u64 / LONG.as_secs();
    assert!(a_second > 100, "{a_second} drive frames a second");
    page.press("Escape")?;
    wait_for_speed(page, 0..=0)?;
    assert_quiet_console(page);
    Ok(())
}
