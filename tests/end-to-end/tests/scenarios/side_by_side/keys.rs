//! The keys that stop, as Chromium hands them to focused controls and to open lists.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console, spin, wait_for_speed, wait_until_enabled,
};
use anyhow::Result;
use end_to_end::{Line, WAIT_MAX, now_us, wait_until};

/// A browser presses a button when Space comes up.
const AFTER_RELEASE: Duration = Duration::from_millis(500);

#[test]
fn space_on_the_button_that_reverses_stops_the_wheel() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    spin(page, "+50", 47..=53)?;
    page.find("button", "-100")?.focus()?;
    let pressed = now_us();
    page.hold_key(" ")?;
    page.wait_for_text("alertdialog", "Stopped", |text| text.contains("confirmed"))?;
    wait_for_speed(page, 0..=0)?;
    page.release_key(" ")?;
    thread::sleep(AFTER_RELEASE);
    let wire = scenario.since(pressed)?;
    assert_ends_braked(&wire);
    let reverses = |rpm: i16| rpm < 0;
    let drives = wire.drives();
    assert!(
        !drives
            .frames
            .iter()
            .any(|frame| frame.drive_setpoint().is_some_and(reverses)),
        "{drives}"
    );
    page.click("button", "Release")?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    // At a standstill the button has it.
    wait_until_enabled(page, "button", "-100", true)?;
    page.find("button", "-100")?.focus()?;
    page.press(" ")?;
    wait_for_speed(page, -103..=-97)?;
    assert_quiet_console(page);
    Ok(())
}

/// Chromium keeps the press to the list, and tells the page of the release only.
#[test]
fn escape_in_an_open_list_stops_the_wheel() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let page = &scenario.page;
    page.click("combobox", "Motor")?;
    wait_until("the list to be open", WAIT_MAX, || {
        let open = page.evaluate("document.querySelector('select:open') !== null")?;
        Ok(if open == true {
            Ok(())
        } else {
            Err("it is closed".to_owned())
        })
    })?;
    let pressed = now_us();
    page.press("Escape")?;
    page.wait_for_text("alertdialog", "Stopped", |text| text.contains("confirmed"))?;
    wait_for_speed(page, 0..=0)?;
    assert_ends_braked(&scenario.since(pressed)?);
    scenario.stays_undriven(Duration::from_secs(1))
}
