//! Lines that lose, spoil, echo and split: what is driven on them, and what is shown of it.

use std::{
    thread,
    time::{Duration, Instant},
};

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console,
    rules::{nothing_but_stops_and_questions, the_log_has_it_all, what_is_shown_is_true},
    wait_for_speed, wait_for_wire,
};
use anyhow::{Result, ensure};
use end_to_end::{Line, Page, WAIT_MAX, now_us, retry, wait_until};

const DRIVEN_FOR: Duration = Duration::from_secs(5);

/// A press shows on the wire in milliseconds, or is refused as fast.
const REFUSED_WITHIN: Duration = Duration::from_secs(1);

/// Where half of all exchanges fail, a press in thirty finds a motor that was not heard for half a second, and
/// is refused.
const PRESSES_MAX: u32 = 5;

/// Where half of all exchanges fail, ten fail in a row in one drive of five, and the motor is lost.
const DRIVES_MAX: u32 = 5;

/// What a wheel that is asked for 100 rpm may have, on its way up and down, with its own ripple.
const TRUE_SPEEDS: std::ops::RangeInclusive<f64> = -5.0..=110.0;

/// Whether the page still has the motor driven; if it has not, it says why.
fn is_driven(page: &Page) -> Result<bool> {
    let title = page.evaluate("document.title")?;
    if title
        .as_str()
        .is_some_and(|title| title.contains("+100 rpm"))
    {
        return Ok(true);
    }
    let said = page.evaluate("document.body.innerText")?;
    let said = said.as_str().unwrap_or_default();
    ensure!(
        said.contains("no reply for 200 ms"),
        "driven no more, and it does not say why: {said}"
    );
    Ok(false)
}

/// Presses +100 until the wire has a drive frame. Where a motor was not heard for a moment the press is
/// refused, and a person who is told so presses again.
fn press_until_driven(scenario: &Scenario) -> Result<u64> {
    retry("press +100", PRESSES_MAX, || {
        let pressed = now_us();
        scenario.page.click("button", "+100")?;
        let driven = wait_until("a drive frame", REFUSED_WITHIN, || {
            let drives = scenario.since(pressed)?.drives();
            Ok((!drives.is_empty()).then_some(()).ok_or_else(String::new))
        });
        if driven.is_ok() {
            return Ok(Ok(pressed));
        }
        // The page says so, or the button was disabled at that moment.
        Ok(Err("the motor had not answered".to_owned()))
    })
}

/// Looks at the page for as long as it is to drive: all that is shown is true, the speed is known most of
/// the time, and a drive that ends says why. Gives why where it ends too early.
fn drives_on(page: &Page) -> Result<Result<(), String>> {
    let (mut looks, mut known) = (0, 0);
    let until = Instant::now() + DRIVEN_FOR;
    while Instant::now() < until {
        looks += 1;
        known += usize::from(what_is_shown_is_true(page, TRUE_SPEEDS)?);
        if !is_driven(page)? {
            return Ok(Err("the motor was lost".to_owned()));
        }
    }
    ensure!(
        known * 2 > looks,
        "the speed is known in {known} of {looks} looks"
    );
    Ok(Ok(()))
}

/// Drives for a while and stops: what is shown is true, the stop ends braked, and the log has every frame.
fn drives_and_stops_truly(scenario: &Scenario, pulls: usize) -> Result<()> {
    let page = &scenario.page;
    let mut pressed = 0;
    retry("drive for a while", DRIVES_MAX, || {
        pressed = press_until_driven(scenario)?;
        // The title follows within a few frames of the screen.
        thread::sleep(Duration::from_secs(1));
        drives_on(page)
    })?;
    let stopped = now_us();
    page.press("Escape")?;
    page.wait_for_text("alertdialog", "Stopped", |text| !text.is_empty())?;
    wait_for_speed(page, 0..=0)?;
    // A frame may have been on its way to the wire.
    let wire = scenario.since(stopped + 100_000)?;
    ensure!(
        !wire.from_host().is_empty(),
        "the motor is not asked any more"
    );
    nothing_but_stops_and_questions(&wire)?;
    assert_ends_braked(&scenario.since(pressed)?);
    scenario.release()?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    wait_until("a speed that is known", WAIT_MAX, || {
        let known = what_is_shown_is_true(page, TRUE_SPEEDS)?;
        Ok(known.then_some(()).ok_or_else(|| "none".to_owned()))
    })?;
    the_log_has_it_all(scenario, pulls)?;
    Ok(())
}

/// Half of all exchanges fail then.
#[test]
fn a_line_that_loses_and_spoils_both_ways_shows_nothing_untrue() -> Result<()> {
    let faults = ["--loss", "0.15", "--corrupt", "0.15", "--seed", "7"];
    let scenario = Scenario::connected(Line::default().with(&faults))?;
    drives_and_stops_truly(&scenario, 0)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

#[test]
fn an_adapter_that_echoes_and_splits_every_read_drives_and_stops() -> Result<()> {
    let faults = ["--echo", "whole", "--split", "--latency-ms", "2"];
    let scenario = Scenario::connected(Line::default().with(&faults))?;
    drives_and_stops_truly(&scenario, 0)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// Everything at once, and a pull of the plug.
#[test]
fn an_adapter_that_does_all_of_it_comes_back_from_a_pull() -> Result<()> {
    let faults = [
        "--echo",
        "cut:5",
        "--split",
        "--lose-replies",
        "0.1",
        "--corrupt-replies",
        "0.1",
    ];
    let mut scenario = Scenario::connected(Line::default().with(&faults))?;
    let pressed = press_until_driven(&scenario)?;
    wait_for_wire(&scenario, pressed, "ten drive frames", |wire| {
        wire.drives().len() >= 10
    })?;
    scenario.adapter.unplug()?;
    let page = &scenario.page;
    page.wait_for_text("status", "Connection", |text| text.contains("Reconnecting"))?;
    let back = now_us();
    scenario.adapter.plug()?;
    let page = &scenario.page;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    thread::sleep(Duration::from_secs(1));
    nothing_but_stops_and_questions(&scenario.since(back)?)?;
    drives_and_stops_truly(&scenario, 1)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// Waits until the doctor names this cause, and gives the figures that it judged by.
fn diagnosed(fault: &[&str], cause: &str, advice: &str) -> Result<String> {
    let scenario = Scenario::connected(Line::default().with(fault))?;
    let page = &scenario.page;
    page.open_panel("Link health")?;
    // It names no wire while the computer is late, as one that is busy is.
    page.wait_for_text_within(Duration::from_secs(60), "list", "Link diagnosis", |text| {
        text.contains(cause) && text.contains(advice)
    })?;
    let figures = page.text("status", "Based on")?;
    assert_quiet_console(page);
    Ok(figures)
}

#[test]
fn the_doctor_tells_loss_from_damage() -> Result<()> {
    let lossy = ["--loss", "0.2", "--seed", "7"];
    let figures = diagnosed(&lossy, "Replies are lost", "loose wire")?;
    assert!(figures.contains(" 0 corrupted"), "{figures}");
    let damaged = ["--corrupt-replies", "0.2", "--seed", "7"];
    let figures = diagnosed(&damaged, "Replies are corrupted", "120 Ω")?;
    assert!(!figures.contains(" 0 corrupted"), "{figures}");
    Ok(())
}
