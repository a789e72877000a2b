//! Experiments run in the port worker: nothing moves before Run, and what ends a run stops it.

use std::{thread, time::Duration};

use anyhow::{Context, Result};
use end_to_end::{Line, Page, now_us};

use crate::fixture::{Scenario, assert_quiet_console};

/// A page with a run that is running, and when Run was pressed.
pub(super) fn running(line: Line) -> Result<(Scenario, u64)> {
    let scenario = Scenario::connected(line)?;
    let page = &scenario.page;
    page.open_panel("Experiments")?;
    page.click("button", "Arm")?;
    page.wait_for_text("status", "Run", |text| text.contains("Armed"))?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    let pressed = now_us();
    page.click("button", "Run")?;
    let running = page.wait_for_text("status", "Run", |text| text.contains("Running"));
    explained(page, running)?;
    thread::sleep(Duration::from_secs(3));
    Ok((scenario, pressed))
}

/// Adds what the page says of the run to the error of a step that needs it.
fn explained<T>(page: &Page, step: Result<T>) -> Result<T> {
    step.with_context(|| {
        let said = page.find("status", "Result of the run");
        let said = said.and_then(|status| status.text());
        format!("the page says of the run: {said:?}")
    })
}

/// The last drive frame since this time brakes.
fn assert_braked_since(scenario: &Scenario, us: u64) -> Result<()> {
    let drives = scenario.since(us)?.drives();
    let brakes = drives.last().is_some_and(end_to_end::Frame::brakes);
    assert!(brakes, "{drives}");
    Ok(())
}

#[test]
fn escape_disarms() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.open_panel("Experiments")?;
    page.click("button", "Arm")?;
    page.wait_for_text("status", "Run", |text| text.contains("Armed"))?;
    page.press("Escape")?;
    page.wait_for_text("status", "Run", |text| !text.contains("Armed"))?;
    assert!(page.find("button", "Run")?.disabled);
    scenario.stays_undriven(Duration::from_secs(1))
}

#[test]
fn a_run_sends_its_setpoints_and_ends_with_stop_for_good() -> Result<()> {
    let (scenario, pressed) = running(Line::default())?;
    let page = &scenario.page;
    let drives = scenario.since(pressed)?.drives();
    // 200 setpoints a second; a busy machine is late.
    assert!(drives.len() > 300, "{drives}");
    let moves = |frame: &end_to_end::Frame| frame.drive_setpoint().is_some_and(|it| it != 0);
    assert!(drives.frames.iter().any(moves), "{drives}");

    let stopped = now_us();
    page.press(" ")?;
    page.wait_for_text("status", "Result of the run", |text| {
        text.contains("stopped by you")
    })?;
    thread::sleep(Duration::from_secs(2));
    assert_braked_since(&scenario, stopped)?;
    scenario.release()?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_reloaded_page_ends_a_run_and_starts_none() -> Result<()> {
    let (scenario, _) = running(Line::default())?;
    let reloaded = now_us();
    scenario.page.reload()?;
    thread::sleep(Duration::from_secs(3));
    assert_braked_since(&scenario, reloaded)?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    Ok(())
}

#[test]
fn pause_sends_zero_and_resume_goes_on() -> Result<()> {
    let (scenario, _) = running(Line::default())?;
    let page = &scenario.page;
    // The graph has a button of this name too.
    let of_run = |button: &end_to_end::Control| button.description.contains("angles are held");
    let named = page.find_all("button", "Pause")?;
    let of_this_run = named.iter().find(|button| of_run(button));
    of_this_run.context("no Pause of the run")?.click()?;
    page.wait_for_text("status", "Run", |text| text.contains("Paused"))?;
    thread::sleep(Duration::from_millis(300));
    let paused = now_us();
    thread::sleep(Duration::from_secs(1));
    let drives = scenario.since(paused)?.drives();
    assert!(!drives.is_empty());
    let is_zero = |frame: &end_to_end::Frame| frame.drive_setpoint() == Some(0);
    assert!(drives.frames.iter().all(is_zero), "{drives}");
    let resumed = now_us();
    page.click("button", "Resume")?;
    thread::sleep(Duration::from_secs(2));
    let drives = scenario.since(resumed)?.drives();
    assert!(!drives.frames.iter().all(is_zero), "{drives}");
    explained(page, page.click("button", "Abort"))?;
    thread::sleep(Duration::from_secs(2));
    scenario.stays_undriven(Duration::from_secs(1))?;
    Ok(())
}
