//! A session survives a crash of the page, and is erased when a person says so.

use std::{thread, time::Duration};

use crate::fixture::{
    assert_quiet_console, connect,
    exports::{Table, hex, undisturbed_replies},
    open_name, spin, wait_until_enabled,
};
use anyhow::Result;
use end_to_end::{Adapter, Bench, Frame, Line, Page, Usb, WAIT_MAX, WireLog, now_us, wait_until};

/// What a crash may cost.
const LOST_US_MAX: u64 = 1_000_000;

/// Drives for some seconds with Record on, then crashes. Gives when.
fn recorded_until_a_crash(bench: &Bench, adapter: &Adapter) -> Result<(WireLog, u64)> {
    let page = bench.open("/")?;
    connect(&page)?;
    page.fill("spinbutton", "Command rate", "120")?;
    page.open_panel("Recording")?;
    page.click("button", "Record telemetry")?;
    spin(&page, "+100", 97..=103)?;
    thread::sleep(Duration::from_secs(3));
    let crashed_us = now_us();
    page.crash();
    Ok((adapter.wire()?, crashed_us))
}

fn offered(page: &Page) -> Result<String> {
    page.wait_for_text("status", "Previous session", |text| {
        text.contains("Session from")
    })
}

fn restore(page: &Page) -> Result<()> {
    page.click("button", "Restore session")?;
    page.open_panel("Recording")?;
    page.wait_for_text("output", "Recorded", |text| {
        // It may have become a file before the crash.
        text.contains("Recorded")
    })?;
    Ok(())
}

/// Waits as long as an offer that comes would take, and finds none.
fn assert_nothing_offered(page: &Page) -> Result<()> {
    thread::sleep(Duration::from_secs(8));
    let offers = page.find_all("button", "Restore session")?;
    assert_eq!(offers.len(), 0);
    Ok(())
}

/// A worker that outlives its page for a moment brakes; nothing else is sent behind a crash.
fn assert_driven_by_nobody(adapter: &Adapter, crashed_us: u64) -> Result<()> {
    let told = adapter.wire()?.since(crashed_us + LOST_US_MAX).drives();
    let moves = |frame: &&Frame| !frame.brakes() && !frame.is_stop();
    let driven = told.frames.iter().find(moves);
    assert!(driven.is_none(), "driven by nobody's command: {driven:?}");
    Ok(())
}

/// These rows are those frames from the first on, up to at most a second before the crash.
fn assert_whole_until_a_second_before(
    what: &str,
    rows: &[&str],
    frames: &[(u64, String)],
    crashed_us: u64,
) -> u64 {
    assert!(rows.len() > 100, "{what}: {} rows", rows.len());
    for (place, (row, (_, frame))) in rows.iter().zip(frames).enumerate() {
        assert_eq!(*row, frame, "{what}, row {place}");
    }
    // The last frame may stand on the wire only when the page is gone.
    let newest_us = frames[rows.len().min(frames.len()) - 1].0;
    let lost_us = crashed_us.saturating_sub(newest_us);
    assert!(lost_us < LOST_US_MAX, "{what}: {lost_us} us are lost");
    lost_us
}

fn timed(wire: &WireLog) -> Vec<(u64, String)> {
    let frames = wire.frames.iter();
    frames.map(|frame| (frame.at_us, hex(frame))).collect()
}

/// Log and telemetry, as the page exports them, against the wire. Gives what was lost of either.
fn compare(page: &Page, wire: &WireLog, crashed_us: u64) -> Result<[u64; 2]> {
    let log = Table::read(&page.download("Export CSV")?)?;
    let directions = log.column("direction")?;
    let sent: Vec<&str> = directions
        .into_iter()
        .zip(log.column("hex")?)
        .filter(|(direction, _)| *direction == "TX")
        .map(|(_, hex)| hex)
        .collect();
    let host = timed(&wire.from_host());
    let lost_log = assert_whole_until_a_second_before("log", &sent, &host, crashed_us);

    page.open_panel("Recording")?;
    let telemetry = Table::read(&page.download("Export telemetry CSV")?)?;
    let raw = telemetry.column("raw_hex")?;
    let replies: Vec<(u64, String)> = undisturbed_replies(wire)
        .iter()
        .map(|reply| (reply.frame.at_us, hex(&reply.frame)))
        .collect();
    // It began some replies after the first.
    let first = replies.windows(20).position(|some| {
        let mut pairs = some.iter().zip(&raw);
        pairs.all(|((_, reply), row)| reply == row)
    });
    let recorded = &replies[first.expect("the recording is a run of replies")..];
    let lost = assert_whole_until_a_second_before("telemetry", &raw, recorded, crashed_us);
    Ok([lost_log, lost])
}

#[test]
fn a_crash_costs_less_than_a_second_and_drives_nothing() -> Result<()> {
    let bench = Bench::reuse()?;
    let adapter = bench.plug(Line::default(), Usb::default())?;
    let (wire, crashed_us) = recorded_until_a_crash(&bench, &adapter)?;

    let page = bench.open("/")?;
    let words = offered(&page)?;
    assert!(words.contains("packets"), "{words}");
    assert!(words.contains("s recorded"), "{words}");
    restore(&page)?;
    let lost_us = compare(&page, &wire, crashed_us)?;
    let restored = Table::read(&page.download("Export CSV")?)?;
    let of_the_first = restored.rows.iter().filter(|row| row[2] == "TX").count();
    println!("lost, us: log {}, telemetry {}", lost_us[0], lost_us[1]);
    assert_driven_by_nobody(&adapter, crashed_us)?;

    // This session stands behind it, and both outlive the next crash.
    let again_us = now_us();
    connect(&page)?;
    let rate = page.find("spinbutton", "Command rate")?.value;
    assert_eq!(rate, "120", "the setup is there by itself");
    thread::sleep(Duration::from_secs(2));
    assert_driven_by_nobody(&adapter, crashed_us)?;
    let crashed_again_us = now_us();
    page.crash();
    let wire = adapter.wire()?;
    let page = bench.open("/")?;
    offered(&page)?;
    restore(&page)?;
    let log = Table::read(&page.download("Export CSV")?)?;
    let is_sent = |row: &&Vec<String>| row[2] == "TX";
    let sent: Vec<&str> = log
        .rows
        .iter()
        .filter(is_sent)
        .map(|row| row[4].as_str())
        .collect();
    // Its frames are much alike: they are counted.
    let behind = timed(&wire.since(again_us).from_host());
    let known = sent.len().saturating_sub(of_the_first);
    let (newest_us, newest) = &behind[known.checked_sub(1).expect("the second session is in it")];
    assert_eq!(sent.last(), Some(&newest.as_str()));
    assert!(crashed_again_us.saturating_sub(*newest_us) < LOST_US_MAX);
    let times = log.column("time")?;
    assert!(times.is_sorted(), "times go forward");
    assert_quiet_console(&page);
    Ok(())
}

/// Pixels on the canvas of the graph's lines.
fn drawn(page: &Page) -> Result<u64> {
    let count = page.evaluate(
        "(() => { const c = document.querySelector('.graph-lines'); \
         if (!c.width || !c.height) return 0; \
         const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; \
         let n = 0; for (let i = 3; i < d.length; i += 4) if (d[i]) n++; return n; })()",
    )?;
    Ok(count.as_u64().unwrap_or(0))
}

/// By a crash and by a reload: the graph is there again with log and samples.
#[test]
fn a_restored_session_has_its_graph() -> Result<()> {
    let bench = Bench::reuse()?;
    let adapter = bench.plug(Line::default(), Usb::default())?;
    recorded_until_a_crash(&bench, &adapter)?;
    let page = bench.open("/")?;
    offered(&page)?;
    assert_eq!(drawn(&page)?, 0, "nothing is known yet");
    restore(&page)?;
    let waits_for_lines = || {
        wait_until("lines in the graph", WAIT_MAX, || {
            let drawn = drawn(&page)?;
            Ok((drawn > 100).then_some(()).ok_or(drawn.to_string()))
        })
    };
    waits_for_lines()?;
    page.reload()?;
    offered(&page)?;
    restore(&page)?;
    waits_for_lines()?;
    // This session stands behind it. What the crash left driven is stopped first; a press before that is refused.
    connect(&page)?;
    page.wait_for_text("region", "Notices", |text| {
        text.contains("Stopped, standstill confirmed")
    })?;
    spin(&page, "+50", 47..=53)?;
    waits_for_lines()?;
    assert_quiet_console(&page);
    Ok(())
}

#[test]
fn what_is_forgotten_and_what_is_erased_is_offered_no_more() -> Result<()> {
    let bench = Bench::reuse()?;
    let adapter = bench.plug(Line::default(), Usb::default())?;
    recorded_until_a_crash(&bench, &adapter)?;
    let page = bench.open("/")?;
    offered(&page)?;
    // It comes while the page loads: then it must not push the buttons away under the mouse.
    let place = "document.querySelector('.first-buttons').getBoundingClientRect().y";
    let beside_the_offer = page.evaluate(place)?;
    // Who does neither is asked again.
    page.click("button", "Dismiss previous session")?;
    assert_eq!(page.evaluate(place)?, beside_the_offer);
    page.reload()?;
    offered(&page)?;
    page.click("button", "Delete session")?;
    page.reload()?;
    assert_nothing_offered(&page)?;

    connect(&page)?;
    open_name(&page)?;
    page.fill("textbox", "Name", "Port")?;
    page.find("button", "Motor 0x01, Port")?;
    page.open_panel("Recording")?;
    page.click("button", "Record telemetry")?;
    page.open_panel("Settings")?;
    wait_until_enabled(&page, "button", "Delete all data", false)?;
    let why = page.find("button", "Delete all data")?.description;
    assert!(why.contains("Stop the recording first"), "{why}");
    thread::sleep(Duration::from_secs(1));
    page.open_panel("Recording")?;
    page.click("button", "Stop recording")?;
    page.click("button", "Disconnect")?;
    page.open_panel("Settings")?;
    page.click("button", "Delete all data")?;
    page.click("button", "Cancel")?;
    assert_ne!(page.evaluate("Object.keys(localStorage).length")?, 0);
    page.click("button", "Delete all data")?;
    page.click("button", "Delete")?;
    page.wait_for_text("status", "Stored in this browser", |text| {
        text.contains("Deleted")
    })?;
    page.open_panel("Recording")?;
    page.wait_for_text("output", "Recorded", |text| text.contains("0 samples"))?;
    let keys = page.evaluate("Object.keys(localStorage).length")?;
    assert_eq!(keys, 0);
    page.reload()?;
    assert_nothing_offered(&page)?;
    connect(&page)?;
    assert_eq!(page.find("spinbutton", "Command rate")?.value, "50");
    page.find("button", "Motor 0x01")?;
    assert_quiet_console(&page);
    Ok(())
}

#[test]
fn the_session_of_another_living_tab_is_left_alone() -> Result<()> {
    let bench = Bench::reuse()?;
    let adapter = bench.plug(Line::default(), Usb::default())?;
    let first = bench.open("/")?;
    connect(&first)?;
    thread::sleep(Duration::from_secs(2));
    let second = bench.open("/")?;
    assert_nothing_offered(&second)?;
    first.show()?;
    first.crash();
    // Chromium may run both tabs in one process.
    let third = bench.open("/")?;
    offered(&third)?;
    assert!(adapter.wire()?.drives().is_empty());
    Ok(())
}
