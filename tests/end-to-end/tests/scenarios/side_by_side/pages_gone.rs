//! Pages that are gone or half gone while a wheel turns: left, or hanging. For those that crash see `left_driven`.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console, connect, number,
    rules::{
        it_drives_again_when_asked, nothing_but_stops_and_questions, nothing_moves_until_asked,
    },
    spin, wait_for_speed,
};
use anyhow::{Context, Result};
use end_to_end::{Bench, Page, now_us};

/// Between leaving and returning: longer than what a page that goes has for its last frames.
const AWAY: Duration = Duration::from_millis(500);

/// Leaves the page for an empty one, and goes back to it.
fn leave_and_return(page: &Page) -> Result<()> {
    page.go("about:blank")?;
    thread::sleep(AWAY);
    page.back()
}

#[test]
fn a_page_left_and_returned_to_has_stopped_the_wheel_and_starts_nothing() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let leaving = now_us();
    leave_and_return(&scenario.page)?;
    assert_ends_braked(&scenario.since(leaving)?);
    // It drives until it learns that it goes, which takes longer on a busy computer.
    let wire = scenario.since(leaving)?.from_host();
    let first_stop = wire.frames.iter().find(|frame| frame.is_stop());
    let stopping = first_stop.context("no stop")?.at_us;
    nothing_but_stops_and_questions(&scenario.since(stopping)?)?;
    let back = now_us();
    nothing_moves_until_asked(&scenario, back)?;
    connect(&scenario.page)?;
    // A page that went before it saw the wheel stand stops it again.
    thread::sleep(Duration::from_secs(1));
    scenario.stays_undriven(Duration::from_secs(1))?;
    nothing_but_stops_and_questions(&scenario.since(back)?)?;
    it_drives_again_when_asked(&scenario.page)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// No port keeps this page from being kept whole and shown again as it was.
#[test]
fn a_page_with_the_virtual_motor_comes_back_stopped() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/?port=virtual")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    spin(&page, "+100", 97..=103)?;
    leave_and_return(&page)?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.wait_for_text("output", "Speed", |text| number(text).is_some())?;
    wait_for_speed(&page, 0..=0)?;
    if !page.find_all("alertdialog", "Stopped")?.is_empty() {
        println!("it was kept whole");
        page.click("button", "Release")?;
    }
    thread::sleep(Duration::from_secs(1));
    wait_for_speed(&page, 0..=0)?;
    it_drives_again_when_asked(&page)?;
    assert_quiet_console(&page);
    Ok(())
}

/// A page that hangs for longer than a dead worker is waited for has a worker all the same.
#[test]
fn a_page_that_hung_does_not_take_its_worker_for_dead() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let hang = "const end = performance.now() + 8000; while (performance.now() < end);";
    scenario
        .page
        .evaluate(&format!("setTimeout(() => {{ {hang} }}); 0"))?;
    thread::sleep(Duration::from_secs(9));
    let page = &scenario.page;
    page.wait_for_text("alertdialog", "Stopped", |text| !text.is_empty())?;
    page.click("button", "Release")?;
    assert!(page.text("status", "Connection")?.contains("Connected"));
    scenario.stays_undriven(Duration::from_secs(1))?;
    it_drives_again_when_asked(page)
}
