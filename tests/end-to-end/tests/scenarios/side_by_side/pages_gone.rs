//! Pages that are gone or half gone while a wheel turns: left, crashed, discarded, without their worker.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_ends_braked, assert_quiet_console, connect, number,
    rules::{
        frames_cease, it_drives_again_when_asked, nothing_but_stops_and_questions,
        nothing_moves_until_asked, the_motor_coasts, the_page_says,
    },
    spin, wait_for_speed,
};
use anyhow::Result;
use end_to_end::{Bench, Page, now_us};

/// Between leaving and returning: longer than what a page that goes has for its last frames.
const AWAY: Duration = Duration::from_millis(500);

/// Keeps the page's workers at hand, so that they can be ended behind its back.
const KEEP_WORKERS: &str = "
    window.kept = [];
    window.Worker = class extends Worker {
        constructor(...all) { super(...all); window.kept.push(this); }
    };
";

/// Opens the page again: it starts nothing by itself, and drives when it is asked to.
fn a_new_page_starts_nothing(scenario: &mut Scenario) -> Result<()> {
    let opened = now_us();
    scenario.page = scenario.bench.open("/")?;
    thread::sleep(Duration::from_secs(1));
    assert!(scenario.since(opened)?.from_host().is_empty());
    connect(&scenario.page)?;
    nothing_moves_until_asked(scenario, opened)?;
    it_drives_again_when_asked(&scenario.page)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// Leaves the page for an empty one, and goes back to it.
fn leave_and_return(page: &Page) -> Result<()> {
    page.go("about:blank")?;
    thread::sleep(AWAY);
    page.back()
}

/// What is left when a page goes without a word: its adapter and its browser, and a page that is new.
fn loses_its_page(scenario: Scenario, how: impl FnOnce(&Bench, Page) -> Result<()>) -> Result<()> {
    let Scenario {
        bench,
        adapter,
        page,
    } = scenario;
    let lost = now_us();
    how(&bench, page)?;
    let page = bench.open("/")?;
    let mut scenario = Scenario {
        bench,
        adapter,
        page,
    };
    frames_cease(&scenario, lost)?;
    the_motor_coasts(&mut scenario)?;
    a_new_page_starts_nothing(&mut scenario)
}

/// A browser that writes down why it crashed does so for seconds, in which the worker lives on.
#[test]
fn a_crashed_page_lets_the_wheel_coast_and_a_new_one_starts_nothing() -> Result<()> {
    loses_its_page(Scenario::spinning()?, |_, page| {
        page.crash();
        Ok(())
    })
}

/// A discard fires no event.
#[test]
fn a_discarded_page_lets_the_wheel_coast_and_a_new_one_starts_nothing() -> Result<()> {
    loses_its_page(Scenario::spinning()?, Bench::discard)
}

#[test]
fn a_page_left_and_returned_to_has_stopped_the_wheel_and_starts_nothing() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let leaving = now_us();
    leave_and_return(&scenario.page)?;
    assert_ends_braked(&scenario.since(leaving)?);
    // What was on its way when the page learnt of it.
    nothing_but_stops_and_questions(&scenario.since(leaving + 100_000)?)?;
    let back = now_us();
    nothing_moves_until_asked(&scenario, back)?;
    connect(&scenario.page)?;
    nothing_moves_until_asked(&scenario, back)?;
    it_drives_again_when_asked(&scenario.page)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// No port keeps this page from being kept whole and shown again as it was.
#[test]
fn a_page_with_the_virtual_motor_comes_back_stopped() -> Result<()> {
    let bench = Bench::start()?;
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

#[test]
fn a_worker_that_is_ended_is_missed_and_the_page_says_how_to_go_on() -> Result<()> {
    let mut scenario = Scenario::spinning()?;
    scenario.page.before_load(KEEP_WORKERS)?;
    scenario.page.reload()?;
    connect(&scenario.page)?;
    it_drives_again_when_asked(&scenario.page)?;
    let ended = now_us();
    scenario.page.evaluate("window.kept[0].terminate()")?;
    frames_cease(&scenario, ended)?;
    the_motor_coasts(&mut scenario)?;
    the_page_says(&scenario.page, "The background worker has stopped")?;
    the_page_says(&scenario.page, "coasts to a standstill")?;
    let known = number(&scenario.page.text("output", "Speed")?);
    assert_eq!(known, None, "nothing is known of the wheel any more");
    let reloading = now_us();
    scenario.page.click("button", "Reload the page")?;
    thread::sleep(Duration::from_secs(1));
    connect(&scenario.page)?;
    nothing_moves_until_asked(&scenario, reloading)?;
    it_drives_again_when_asked(&scenario.page)
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
