//! The page is used while it still comes.

use std::time::Duration;

use crate::fixture::{Scenario, assert_quiet_console, connect, spin};
use anyhow::Result;
use end_to_end::{Bench, FirstPress, Frame, Line, Page, Slowness, WAIT_MAX, now_us, wait_until};

/// Slow enough for a press to come before the worker.
const SLOWNESS: Slowness = Slowness {
    processor: 4.0,
    slow_4g: false,
};

/// Presses a button while the page still comes.
fn press_early(bench: &Bench, button: &str) -> Result<Page> {
    let (page, first) = FirstPress::on(bench, SLOWNESS, button)?;
    let FirstPress {
        usable_ms,
        whole_ms,
    } = first;
    assert!(
        usable_ms < whole_ms,
        "usable {usable_ms} ms, whole {whole_ms} ms"
    );
    Ok(page)
}

#[test]
fn a_press_before_all_of_the_page_is_there_connects_once_it_is() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = press_early(&bench, "Virtual motor")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.wait_for_text("output", "Mode", |text| text.contains("elocity"))?;
    assert_quiet_console(&page);
    Ok(())
}

#[test]
fn help_asked_for_before_all_of_the_page_is_there_has_the_focus_once_it_is() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = press_early(&bench, "Help")?;
    wait_until("the focus on the help", WAIT_MAX, || {
        let focus = page.evaluate("document.activeElement.role")?;
        Ok(if focus == "dialog" {
            Ok(())
        } else {
            Err(focus.to_string())
        })
    })?;
    assert_quiet_console(&page);
    Ok(())
}

#[test]
fn a_finished_tour_of_a_virtual_motor_has_three_steps_and_stays_finished() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    page.click("button", "Virtual motor")?;
    page.find("button", "Spin at 20 rpm")?;
    let steps = "[...document.querySelectorAll('.tour-steps li:not([hidden])')].map((it) => it.textContent).join()";
    assert_eq!(
        page.evaluate(steps)?,
        "Wait for a reply,Spin the wheel,Stop it"
    );
    spin(&page, "Spin at 20 rpm", 17..=23)?;
    page.click("button", "Stop the wheel")?;
    let done = |text: &str| text.starts_with("Done");
    page.wait_for_text("status", "First spin", done)?;
    page.click("button", "Disconnect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    page.click("button", "Virtual motor")?;
    page.wait_for_text("status", "First spin", done)?;
    assert_quiet_console(&page);
    Ok(())
}

#[test]
fn targets_are_remembered_across_a_reload_and_drive_nothing() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.fill("spinbutton", "Target speed", "42")?;
    page.fill("spinbutton", "Acceleration", "5")?;
    page.reload()?;
    let reloaded = now_us();
    connect(page)?;
    assert_eq!(page.find("spinbutton", "Target speed")?.value, "42");
    assert_eq!(page.find("spinbutton", "Acceleration")?.value, "5");
    scenario.stays_undriven(Duration::from_secs(1))?;
    let drives = scenario.since(reloaded)?.drives();
    assert!(drives.frames.iter().all(Frame::is_stop), "{drives}");
    spin(page, "Start", 39..=45)?;
    assert_quiet_console(page);
    Ok(())
}
