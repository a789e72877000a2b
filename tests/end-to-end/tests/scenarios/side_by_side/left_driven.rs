//! Motors keep their last command when frames cease: what was driven is stopped first by whatever opens the port next.

use std::{thread, time::Duration};

use crate::fixture::{
    Scenario, assert_quiet_console, connect,
    rules::{
        it_drives_again_when_asked, nothing_but_stops_and_questions, nothing_moves_until_asked,
        the_page_says,
    },
    spin,
};
use anyhow::{Context, Result, ensure};
use end_to_end::{Bench, Frame, Line, Page, now_us};

/// From the moment when the port is back, or Connect is pressed, to the confirmed standstill.
const STANDS_WITHIN_US: u64 = 1_500_000;
/// From the death of the worker to the first stop frame.
const STOPS_WITHIN_US: u64 = 1_000_000;
/// The page counts a worker as failed that has sent no ping for four checks, 333 ms apart.
const NOTICED_WITHIN_US: u64 = 4 * 333_000;
/// Chromium lets a worker that is terminated end by itself for so long, and then forces it to. Its port is not free before.
const ENDED_WITHIN_US: u64 = 2_000_000;

/// What a worker has written when it ends is on the wire this soon.
const LAST_WRITE_WITHIN_US: u64 = 200_000;

/// Keeps the page's workers at hand, so that they can be ended behind its back.
const KEEP_WORKERS: &str = "
    window.kept = [];
    window.Worker = class extends Worker {
        constructor(...all) { super(...all); window.kept.push(this); }
    };
";

/// The first frame since a moment is a stop, the wheel stands soon, and the page says so. Prints the times.
fn is_stopped_first(
    scenario: &mut Scenario,
    what: &str,
    from_us: u64,
    says: &str,
    stands_within_us: u64,
) -> Result<u64> {
    scenario
        .page
        .wait_for_text("region", "Notices", |text| text.contains(says))?;
    let said_us = now_us();
    let wire = scenario.since(from_us)?.from_host();
    let first = wire.frames.first().context("no frame")?;
    let switches = first.bytes.starts_with(&[1, 0xA0]);
    ensure!(
        first.is_stop() || switches,
        "the first frame is no stop:\n{wire}"
    );
    let drives = wire.drives();
    ensure!(
        drives.frames.iter().all(Frame::is_stop),
        "driven by nobody's command:\n{drives}"
    );
    let last = drives.frames.last().context("no stop frame")?;
    let after_ms = |us: u64| us.saturating_sub(from_us) / 1000;
    println!(
        "{what}: first stop frame after {} ms, standstill confirmed after {} ms, said within {} ms",
        after_ms(first.at_us),
        after_ms(last.at_us),
        after_ms(said_us),
    );
    let state = scenario.adapter.act("state 1")?;
    ensure!(
        state.contains("rpm=0.0") || state.contains("rpm=-0.0"),
        "{state}"
    );
    ensure!(last.at_us < from_us + stands_within_us, "too late: {wire}");
    Ok(first.at_us - from_us)
}

/// The motor turns on as it was told last, though no frame comes.
fn it_keeps_turning(scenario: &mut Scenario) -> Result<()> {
    let state = scenario.adapter.act("state 1")?;
    ensure!(state.contains("driven=true"), "{state}");
    Ok(())
}

#[test]
fn an_adapter_pulled_out_at_100_rpm_comes_back_and_the_wheel_is_stopped_first() -> Result<()> {
    let mut scenario = Scenario::spinning()?;
    scenario.adapter.unplug()?;
    scenario
        .page
        .wait_for_text("status", "Connection", |text| text.contains("Reconnecting"))?;
    it_keeps_turning(&mut scenario)?;
    let back_us = now_us();
    scenario.adapter.plug()?;
    is_stopped_first(
        &mut scenario,
        "replug",
        back_us,
        "Stopped, standstill confirmed",
        STANDS_WITHIN_US,
    )?;
    scenario
        .page
        .wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    thread::sleep(Duration::from_secs(1));
    nothing_but_stops_and_questions(&scenario.since(back_us)?)?;
    it_drives_again_when_asked(&scenario.page)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// A new page that connects stops what the one before it has left driven.
fn the_next_page_stops_it(
    scenario: Scenario,
    what: &str,
    ends: impl FnOnce(&mut Bench, Page) -> Result<()>,
) -> Result<Scenario> {
    let Scenario {
        mut bench,
        adapter,
        page,
    } = scenario;
    ends(&mut bench, page)?;
    let page = bench.open("/")?;
    let mut scenario = Scenario {
        bench,
        adapter,
        page,
    };
    it_keeps_turning(&mut scenario)?;
    let pressed_us = now_us();
    scenario.page.click("button", "Connect motor")?;
    is_stopped_first(
        &mut scenario,
        what,
        pressed_us,
        "Stopped, standstill confirmed",
        STANDS_WITHIN_US,
    )?;
    scenario
        .page
        .wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    spin(&scenario.page, "+100", 97..=103)?;
    Ok(scenario)
}

/// A page that crashes is left to its worker for a while, which then stops the motors by its watchdog.
#[test]
fn what_a_discarded_page_or_a_killed_browser_drove_is_stopped_first() -> Result<()> {
    let scenario = Scenario::spinning()?;
    let scenario =
        the_next_page_stops_it(scenario, "killed tab", |bench, page| bench.discard(page))?;
    let scenario = the_next_page_stops_it(scenario, "killed browser", |bench, page| {
        drop(page);
        bench.kill_browser()
    })?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// A worker fails that drives a wheel, and another one stops it within this time. `fails` gives the moment of the failure.
fn another_worker_stops_it(
    what: &str,
    within_us: u64,
    fails: impl FnOnce(&Page) -> Result<u64>,
) -> Result<()> {
    let mut scenario = Scenario::connected(Line::default())?;
    scenario.page.before_load(KEEP_WORKERS)?;
    scenario.page.reload()?;
    connect(&scenario.page)?;
    spin(&scenario.page, "+100", 97..=103)?;
    let failed_us = fails(&scenario.page)?;
    let says = "Stopped, standstill confirmed: 0x01";
    the_page_says(&scenario.page, says)?;
    // What the worker wrote before it failed may come out after it.
    let drives = scenario.since(failed_us)?.drives();
    let its_last = drives.frames.iter().rfind(|frame| !frame.is_stop());
    let from_us = its_last.map_or(failed_us, |frame| frame.at_us + 1);
    ensure!(from_us < failed_us + LAST_WRITE_WITHIN_US, "{drives}");
    let wire = scenario.since(from_us)?.from_host();
    let its_own = wire.until(failed_us + LAST_WRITE_WITHIN_US);
    let its_queries = its_own
        .frames
        .iter()
        .take_while(|frame| frame.bytes.get(1) == Some(&0x74));
    let from_us = its_queries.last().map_or(from_us, |frame| frame.at_us + 1);
    let stands_within_us = within_us + STANDS_WITHIN_US - STOPS_WITHIN_US;
    let took_us = is_stopped_first(&mut scenario, what, from_us, says, stands_within_us)?;
    ensure!(took_us < within_us, "{took_us} us");
    let reloading = now_us();
    scenario.page.click("button", "Reload the page")?;
    thread::sleep(Duration::from_secs(1));
    connect(&scenario.page)?;
    nothing_moves_until_asked(&scenario, reloading)?;
    it_drives_again_when_asked(&scenario.page)
}

#[test]
fn what_a_dead_worker_drove_is_stopped_by_another_one_within_a_second() -> Result<()> {
    another_worker_stops_it("dead worker", STOPS_WITHIN_US, |page| {
        let ended_us = now_us();
        page.evaluate("window.kept[0].terminate()")?;
        Ok(ended_us)
    })
}

#[test]
fn what_a_worker_that_hangs_drove_is_stopped_by_another_one() -> Result<()> {
    let within_us = NOTICED_WITHIN_US + ENDED_WITHIN_US + STOPS_WITHIN_US;
    another_worker_stops_it("hung worker", within_us, |page| {
        page.hang_worker("worker")?;
        Ok(now_us())
    })
}
