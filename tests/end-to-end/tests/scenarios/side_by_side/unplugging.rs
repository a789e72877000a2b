//! The adapter pulled out and put back, whatever the page is at.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_quiet_console, number,
    rules::{
        it_drives_again_when_asked, nothing_but_stops_and_questions, the_log_has_it_all,
        the_page_says, the_recording_is_intact,
    },
    spin, wait_for_speed, wait_for_wire,
};
use anyhow::Result;
use end_to_end::{Frame, Line, now_us, wait_until};

/// A full scan on a held-up machine.
const SCAN_MAX: Duration = Duration::from_secs(120);

/// Pulls the adapter out of what it does and puts it back: the page says so both times and finds the
/// adapter by itself, nothing moves, and log and recording go on.
fn survives_a_pull(scenario: &mut Scenario) -> Result<()> {
    let pulled_us = now_us();
    scenario.adapter.unplug()?;
    let page = &scenario.page;
    page.wait_for_text("status", "Connection", |text| text.contains("Reconnecting"))?;
    the_page_says(page, "Adapter unplugged")?;
    let back_us = now_us();
    scenario.adapter.plug()?;
    let page = &scenario.page;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.open_panel("Telemetry")?;
    page.wait_for_text("output", "Speed", |text| number(text).is_some())?;
    thread::sleep(Duration::from_secs(1));
    nothing_but_stops_and_questions(&scenario.since(back_us)?)?;
    let log = the_log_has_it_all(scenario, 1)?;
    let said = log.column("meaning")?.join("\n");
    for words in ["Adapter unplugged", "Adapter reconnected"] {
        assert!(said.contains(words), "the log does not say {words:?}");
    }
    the_recording_is_intact(scenario, pulled_us)
}

fn goes_on(scenario: &Scenario) -> Result<()> {
    it_drives_again_when_asked(&scenario.page)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

#[test]
fn an_adapter_pulled_out_of_an_idle_page_comes_back() -> Result<()> {
    let mut scenario = Scenario::connected(Line::default())?;
    survives_a_pull(&mut scenario)?;
    goes_on(&scenario)
}

#[test]
fn an_adapter_pulled_out_of_the_current_loop_comes_back_and_drives_nothing() -> Result<()> {
    let mut scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.click("tab", "Current")?;
    page.click("button", "+0.5 A")?;
    page.wait_for_text("output", "Mode", |text| {
        text.to_lowercase().contains("current")
    })?;
    wait_for_speed(page, 30..=250)?;
    // The stop ends in the velocity loop: a current would be a speed.
    survives_a_pull(&mut scenario)?;
    scenario.page.wait_for_text("output", "Mode", |text| {
        text.to_lowercase().contains("velocity")
    })?;
    goes_on(&scenario)
}

/// What was being stopped stays stopped: until a person releases it nothing drives.
#[test]
fn an_adapter_pulled_out_during_a_stop_comes_back_stopped() -> Result<()> {
    let mut scenario = Scenario::spinning()?;
    let pressed = now_us();
    scenario.page.press("Escape")?;
    wait_for_wire(&scenario, pressed, "the first brake", |wire| {
        wire.frames.iter().any(Frame::brakes)
    })?;
    survives_a_pull(&mut scenario)?;
    let page = &scenario.page;
    page.wait_for_text("alertdialog", "Stopped", |text| !text.is_empty())?;
    scenario.release()?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    goes_on(&scenario)
}

#[test]
fn an_adapter_pulled_out_during_a_scan_comes_back_and_the_scan_does_not_go_on() -> Result<()> {
    // Silent addresses are waited for longer where bytes are held, so there is time to pull.
    let mut scenario = Scenario::connected(Line::default().with(&["--latency-ms", "16"]))?;
    let page = &scenario.page;
    page.open_panel("ID Manager")?;
    let pressed = now_us();
    let buttons = page.find_all("button", "Full scan")?;
    buttons.last().unwrap().click()?;
    wait_for_wire(&scenario, pressed, "a scan at address 20", |wire| {
        !wire.of_motor(20).is_empty()
    })?;
    let pulled = now_us();
    survives_a_pull(&mut scenario)?;
    let asked = scenario.since(pulled)?.from_host();
    let others = |frame: &&Frame| !matches!(frame.id(), Some(1 | 0xC8));
    let others = asked.frames.iter().filter(others).count();
    // Those before the page knew of the pull.
    assert!(others <= 3, "the scan went on:\n{asked}");
    goes_on(&scenario)
}

/// Whether the motor took its new ID is not known then, and nothing is sent again.
#[test]
fn an_adapter_pulled_out_during_an_id_change_comes_back_and_changes_nothing() -> Result<()> {
    let mut scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    page.open_panel("ID Manager")?;
    page.fill("spinbutton", "New ID", "5")?;
    page.click("button", "Set ID")?;
    wait_until("the question", SCAN_MAX, || {
        let question = page.find_all("alertdialog", "Change the ID?")?;
        Ok(question
            .first()
            .map(|_| ())
            .ok_or_else(|| "none".to_owned()))
    })?;
    let agreed = now_us();
    page.click("button", "Set ID 0x05")?;
    wait_for_wire(
        &scenario,
        agreed,
        "the first frame that sets the ID",
        |wire| wire.frames.iter().any(sets_id),
    )?;
    survives_a_pull(&mut scenario)?;
    let sent = scenario.since(agreed)?;
    let sent = sent.frames.iter().filter(|frame| sets_id(frame)).count();
    assert!(sent <= 5, "{sent} frames that set an ID");
    assert!(
        scenario
            .page
            .find_all("alertdialog", "Change the ID?")?
            .is_empty()
    );
    goes_on(&scenario)
}

fn sets_id(frame: &Frame) -> bool {
    frame.bytes.starts_with(&[0xAA, 0x55, 0x53])
}

#[test]
fn an_adapter_pulled_out_at_500_hz_comes_back_and_drives_nothing() -> Result<()> {
    let mut scenario = Scenario::connected(Line {
        turnaround_us: 100,
        ..Line::default()
    })?;
    let page = &scenario.page;
    page.fill("spinbutton", "Command rate", "500")?;
    spin(page, "+100", 97..=103)?;
    survives_a_pull(&mut scenario)?;
    goes_on(&scenario)
}
