//! Stopping: by every way a person or a browser can end a drive.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console, number, spin, wait_for_speed,
};
use anyhow::Result;
use end_to_end::{Line, now_us};

fn in_the_current_loop() -> Result<Scenario> {
    let scenario = Scenario::connected(Line::default())?;
    scenario.page.click("tab", "Current")?;
    scenario.page.click("button", "+0.5 A")?;
    scenario
        .page
        .wait_for_text("output", "Mode", |t| t.to_lowercase().contains("current"))?;
    wait_for_speed(&scenario.page, 30..=250)?;
    Ok(scenario)
}

fn in_the_position_loop() -> Result<Scenario> {
    let scenario = Scenario::connected(Line::default())?;
    scenario.page.click("tab", "Position")?;
    scenario.page.click("button", "180°")?;
    scenario
        .page
        .wait_for_text("output", "Mode", |t| t.to_lowercase().contains("position"))?;
    let there = |text: &str| number(text).is_some_and(|angle| (angle - 180.0).abs() < 3.0);
    scenario.page.wait_for_text("output", "Position", there)?;
    Ok(scenario)
}

fn stops_and_stays_stopped(scenario: &Scenario, by: impl FnOnce() -> Result<()>) -> Result<()> {
    let page = &scenario.page;
    let asked = now_us();
    by()?;
    page.wait_for_text("alertdialog", "Stopped", |text| !text.is_empty())?;
    wait_for_speed(page, 0..=0)?;
    page.wait_for_text("alertdialog", "Stopped", |text| {
        text.to_lowercase().contains("confirmed")
    })?;
    assert_ends_braked(&scenario.since(asked)?);
    scenario.stays_undriven(Duration::from_secs(1))?;
    page.click("button", "Release")?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn the_button_space_and_escape_stop_a_turning_wheel() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let page = &scenario.page;
    stops_and_stays_stopped(&scenario, || page.click("button", "STOP all motors"))?;
    spin(page, "+100", 97..=103)?;
    page.evaluate("document.activeElement?.blur()")?;
    stops_and_stays_stopped(&scenario, || page.press(" "))?;
    page.click("button", "-50")?;
    wait_for_speed(page, -53..=-47)?;
    page.find("spinbutton", "Target speed")?.focus()?;
    stops_and_stays_stopped(&scenario, || page.press("Escape"))
}

#[test]
fn a_stop_from_the_current_loop_brakes_in_the_velocity_loop() -> Result<()> {
    let scenario = in_the_current_loop()?;
    stops_and_stays_stopped(&scenario, || scenario.page.press("Escape"))
}

/// Zero is "turn to 0 degrees" there, so none may be sent before the velocity loop is reported.
#[test]
fn a_stop_from_the_position_loop_does_not_turn_the_wheel() -> Result<()> {
    let scenario = in_the_position_loop()?;
    let asked = now_us();
    stops_and_stays_stopped(&scenario, || scenario.page.press("Escape"))?;
    let wire = scenario.since(asked)?;
    let first_stop = wire
        .drives()
        .frames
        .iter()
        .find(|frame| frame.is_stop())
        .unwrap()
        .at_us;
    let velocity = wire
        .from_motors()
        .frames
        .iter()
        .find(|f| f.bytes[1] == 2)
        .unwrap()
        .at_us;
    assert!(velocity < first_stop, "{wire}");
    let angle = number(&scenario.page.text("output", "Position")?).unwrap();
    assert!((angle - 180.0).abs() < 5.0, "{angle}");
    Ok(())
}

#[test]
fn a_closed_tab_leaves_stops_as_its_last_frames() -> Result<()> {
    let Scenario {
        bench,
        adapter,
        page,
    } = Scenario::spinning()?;
    let closing = now_us();
    bench.close(page)?;
    thread::sleep(Duration::from_millis(500));
    let wire = adapter.wire()?.since(closing);
    assert_ends_braked(&wire);
    let stops = wire
        .drives()
        .frames
        .iter()
        .filter(|frame| frame.brakes())
        .count();
    assert!(stops >= 10, "{stops} stop frames:\n{wire}");
    // The wheel stood when the last of them was answered.
    let last = wire.from_motors().last().unwrap().bytes.clone();
    let rpm = i16::from_be_bytes([last[4], last[5]]);
    assert!(rpm.abs() <= 10, "{rpm} rpm in the last reply");
    Ok(())
}

#[test]
fn a_reloaded_page_has_stopped_the_wheel_and_starts_nothing() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let reloading = now_us();
    scenario.page.reload()?;
    assert_ends_braked(&scenario.since(reloading)?);
    scenario.stays_undriven(Duration::from_secs(2))?;
    crate::fixture::connect(&scenario.page)?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    wait_for_speed(&scenario.page, 0..=0)
}

#[test]
fn a_frozen_page_has_stopped_the_wheel() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let freezing = now_us();
    scenario.page.freeze()?;
    thread::sleep(Duration::from_millis(1_500));
    assert_ends_braked(&scenario.since(freezing)?);
    scenario.stays_undriven(Duration::from_secs(1))
}

#[test]
fn a_hidden_page_goes_on_driving_and_says_so_in_its_title() -> Result<()> {
    let scenario = Scenario::spinning()?;
    scenario.bench.hide(&scenario.page)?;
    let hidden = now_us();
    thread::sleep(Duration::from_secs(5));
    // A hidden page's own timers would give five. How even they are is a figure of the bench.
    let drives = scenario.since(hidden)?.drives();
    assert!(drives.len() > 150, "{} drive frames", drives.len());
    let title = scenario.page.evaluate("document.title")?;
    assert!(
        title
            .as_str()
            .is_some_and(|title| title.contains("100 rpm")),
        "{title}"
    );
    scenario.page.show()?;
    wait_for_speed(&scenario.page, 97..=103)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

#[test]
fn a_hidden_page_stops_where_it_was_told_to() -> Result<()> {
    let scenario = Scenario::spinning()?;
    scenario.page.open_panel("Settings")?;
    scenario
        .page
        .click("checkbox", "Keep driving while hidden")?;
    let hiding = now_us();
    scenario.bench.hide(&scenario.page)?;
    thread::sleep(Duration::from_secs(1));
    assert_ends_braked(&scenario.since(hiding)?);
    scenario.page.show()?;
    wait_for_speed(&scenario.page, 0..=0)?;
    scenario.stays_undriven(Duration::from_secs(1))
}

/// A page that hangs answers no ping; the worker stops the wheel for it.
#[test]
fn a_hung_page_has_its_wheel_stopped_within_a_second() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let hanging = now_us();
    scenario.page.evaluate(
        "setTimeout(() => { const end = performance.now() + 3000; while (performance.now() < end); })",
    )?;
    thread::sleep(Duration::from_millis(1_600));
    let wire = scenario.since(hanging)?;
    assert_ends_braked(&wire);
    let first_stop = wire
        .drives()
        .frames
        .iter()
        .find(|frame| frame.brakes())
        .unwrap()
        .at_us;
    assert!(
        first_stop - hanging < 1_400_000,
        "{} us",
        first_stop - hanging
    );
    thread::sleep(Duration::from_secs(2));
    scenario
        .page
        .wait_for_text("alertdialog", "Stopped", |text| !text.is_empty())?;
    scenario.stays_undriven(Duration::from_secs(1))
}

/// The page hangs for 0.7 s with a press in its hands: too short for the worker to miss it, too long for a
/// hand that is still where it was.
#[test]
fn an_act_that_comes_late_starts_nothing() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    let press_after = |ms: u32| {
        page.evaluate(&format!(
            "(() => {{
                const press = new MouseEvent('click', {{ bubbles: true, cancelable: true }});
                const until = performance.now() + {ms};
                while (performance.now() < until);
                const is = (it) => it.ariaLabel === '+100';
                const button = [...document.querySelectorAll('button')].find(is);
                // Behind what the worker has told meanwhile, without which the page itself refuses.
                setTimeout(() => button.dispatchEvent(press), 200);
            }})()"
        ))
    };
    press_after(700)?;
    page.wait_for_text("region", "Notices", |text| text.contains("timed out"))?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    press_after(0)?;
    wait_for_speed(page, 97..=103)
}
