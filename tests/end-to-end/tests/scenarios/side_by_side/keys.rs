//! The keys that stop, as Chromium hands them to focused controls and to open lists.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console, number, spin, spin_by, wait_for_speed,
    wait_until_enabled,
};
use anyhow::{Result, bail};
use end_to_end::{Bench, Frame, Line, Page, WAIT_MAX, now_us, wait_until};

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
    scenario.release()?;
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

/// Waits until a control of this role and name exists, or until it does not.
fn wait_until_open(page: &Page, role: &str, name: &str, open: bool) -> Result<()> {
    let how = if open { "open" } else { "closed" };
    wait_until(&format!("{role} {name:?} to be {how}"), WAIT_MAX, || {
        let is_open = !page.find_all(role, name)?.is_empty();
        Ok(if is_open == open {
            Ok(())
        } else {
            Err("it is not".to_owned())
        })
    })
}

#[test]
fn escape_closes_one_thing_at_a_time_and_stops_what_is_driven() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.open_panel("Settings")?;
    page.click("button", "Setup link")?;
    wait_until_open(page, "region", "Setup link", true)?;
    page.fill("searchbox", "Filter", "query")?;
    page.click("button", "Help")?;
    wait_until_open(page, "dialog", "Help", true)?;
    page.press("Escape")?;
    wait_until_open(page, "dialog", "Help", false)?;
    page.find("searchbox", "Filter")?.focus()?;
    let typed = "document.activeElement.value";
    assert_eq!(page.evaluate(typed)?, "query");
    page.press("Escape")?;
    assert_eq!(page.evaluate(typed)?, "");
    assert!(
        !page.find_all("region", "Setup link")?.is_empty(),
        "one thing"
    );
    page.press("Escape")?;
    wait_until_open(page, "region", "Setup link", false)?;
    page.press("Escape")?;
    thread::sleep(AFTER_RELEASE);
    assert!(page.find_all("alertdialog", "Stopped")?.is_empty());
    // Nothing is latched: the motor drives at once. Now Escape stops it, and closes nothing more.
    page.open_panel("Control")?;
    page.click("button", "Virtual motors")?;
    wait_until_open(page, "region", "Virtual motors", true)?;
    spin_by("press 1", page, 47..=53, || page.press("1"))?;
    let pressed = now_us();
    page.press("Escape")?;
    page.wait_for_text("alertdialog", "Stopped", |text| text.contains("confirmed"))?;
    wait_for_speed(page, 0..=0)?;
    assert_ends_braked(&scenario.since(pressed)?);
    assert!(!page.find_all("region", "Virtual motors")?.is_empty());
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_second_stop_keeps_the_cause_of_the_first() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.open_panel("Settings")?;
    page.click("checkbox", "Keep driving while hidden")?;
    page.open_panel("Control")?;
    spin(page, "+50", 47..=53)?;
    scenario.bench.hide(page)?;
    page.show()?;
    let hidden = |text: &str| text.contains("hidden") && text.contains("confirmed");
    page.wait_for_text("alertdialog", "Stopped", hidden)?;
    let pressed = now_us();
    page.click("button", "STOP all motors")?;
    thread::sleep(AFTER_RELEASE);
    let text = page.text("alertdialog", "Stopped")?;
    assert!(text.contains("hidden"), "{text}");
    page.click("button", "Release")?;
    let drives = scenario.since(pressed)?.drives();
    assert!(drives.frames.iter().all(Frame::is_stop), "{drives}");
    Ok(())
}

/// From the first Tab to the press that drives.
const KEYS_MAX: usize = 6;

/// Waits until this is true of the focused element, `it`.
fn wait_for_focus(page: &Page, wanted: &str) -> Result<()> {
    wait_until(&format!("the focus where {wanted}"), WAIT_MAX, || {
        let there = page.evaluate(&format!(
            "((it) => Boolean({wanted}))(document.activeElement)"
        ))?;
        let at = page.evaluate("document.activeElement.outerHTML.slice(0, 200)")?;
        Ok(if there == true {
            Ok(())
        } else {
            Err(at.to_string())
        })
    })
}

/// Presses Tab until this is true of the focused element. Returns how often.
fn tab_to(page: &Page, wanted: &str) -> Result<usize> {
    for presses in 1..=KEYS_MAX {
        page.press("Tab")?;
        if page.evaluate(&format!("((it) => {wanted})(document.activeElement)"))? == true {
            return Ok(presses);
        }
    }
    bail!("more than {KEYS_MAX} times Tab to where {wanted}")
}

#[test]
fn six_keys_lead_from_load_to_a_turning_wheel() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    let mut presses = tab_to(&page, "it.className === 'skip'")?;
    page.press("Enter")?;
    wait_for_focus(&page, "it.id === 'control'")?;
    presses += 1 + tab_to(&page, "it.textContent === 'Virtual motor'")?;
    page.press("Enter")?;
    page.wait_for_text("output", "Speed", |text| number(text).is_some())?;
    wait_until_enabled(&page, "button", "Start", true)?;
    wait_for_focus(&page, "it.id === 'control'")?;
    page.press("f")?;
    presses += 2;
    wait_for_speed(&page, 97..=103)?;
    assert!(presses <= KEYS_MAX, "{presses} key presses");
    page.press(" ")?;
    wait_for_focus(&page, "it.closest('.stopped')")?;
    assert_quiet_console(&page);
    Ok(())
}

#[test]
fn the_focus_is_never_lost() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    let press = |role: &str, name: &str, key: &str| {
        wait_until_enabled(&page, role, name, true)?;
        page.find(role, name)?.focus()?;
        page.press(key)
    };
    let in_tour = "it.closest('.tour')";
    page.press("Tab")?;
    wait_for_focus(&page, "it.className === 'skip'")?;
    page.press("Enter")?;
    wait_for_focus(&page, "it.id === 'control'")?;

    press("button", "Virtual motor", "Enter")?;
    page.wait_for_text("output", "Speed", |text| number(text).is_some())?;
    wait_for_focus(&page, "it.id === 'control'")?;
    press("button", "Spin at 20 rpm", "Enter")?;
    wait_for_speed(&page, 17..=23)?;
    wait_for_focus(&page, in_tour)?;
    page.press(" ")?;
    page.wait_for_text("alertdialog", "Stopped", |text| text.contains("confirmed"))?;
    wait_for_focus(&page, "it.closest('.stopped')")?;
    press("button", "Release", "Enter")?;
    wait_until_open(&page, "alertdialog", "Stopped", false)?;
    // Not on a button: the next Enter presses nothing.
    wait_for_focus(&page, "it.id === 'control'")?;
    press("button", "End the tour", "Enter")?;
    // The notices have nothing to say, and no place.
    wait_for_focus(&page, "it.id === 'control'")?;

    press("button", "Help", "Enter")?;
    wait_for_focus(&page, "it.closest('.help')")?;
    page.press("Escape")?;
    wait_for_focus(&page, "it.ariaLabel === 'Help'")?;
    for place in ["Record", "Test", "Diagnose", "Drive", "Setup"] {
        press("button", place, "Enter")?;
        wait_for_focus(&page, &format!("it.textContent === {place:?}"))?;
    }
    press("button", "Setup link", "Enter")?;
    wait_for_focus(&page, "it.closest('[aria-label=\"Setup link\"]')")?;
    page.press("Escape")?;
    wait_for_focus(&page, "it.textContent === 'Setup link'")?;
    // What is shown in another place has the focus no more.
    page.find("spinbutton", "Speed limit")?.focus()?;
    page.press("Alt+1")?;
    wait_for_focus(&page, "it.id === 'control'")?;
    // And the place that a key opens has it at once, although its opener stays in sight.
    page.find("button", "Help")?.focus()?;
    page.press("Alt+5")?;
    wait_for_focus(&page, "it.id === 'control'")?;
    assert_quiet_console(&page);
    Ok(())
}
