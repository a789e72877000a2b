//! A session is saved while a motor drives, and opened again.

use std::{fs, time::Duration};

use crate::fixture::{
    Scenario, assert_quiet_console, number,
    places::{LAPTOP, READ_OUTS, all_in_sight, in_sight, look},
    spin, stop_and_release,
};
use anyhow::{Context, Result, anyhow, ensure};
use end_to_end::{Line, View, WAIT_MAX, now_us, wait_until};
use motorlink_messages::bus::LineEventKind;
use motorlink_session::{Record, Session, for_each_record, open};

/// Makes the browser's dialog give a file of the page's private file system.
const DIALOG: &str = "window.showSaveFilePicker = async () => {
    const folder = await navigator.storage.getDirectory();
    return (window.chosen = await folder.getFileHandle('chosen.mcap', { create: true }));
}, true";

/// The bytes of that file, as numbers.
const CHOSEN: &str = "(async () => {
    if (!window.chosen) return [];
    const file = await window.chosen.getFile();
    return Array.from(new Uint8Array(await file.arrayBuffer()));
})()";

/// No drive frame is later than this behind the one before: the page stops a motor after 500 ms.
const GAP_US_MAX: u64 = 250_000;

fn records(file: &[u8]) -> Result<Vec<Record>> {
    let mut source = file;
    let session = open(&mut source)??;
    let mut records = Vec::new();
    let problems = for_each_record(&mut source, &session, |record| records.push(record))?;
    ensure!(problems.is_empty(), "{problems}");
    Ok(records)
}

/// The frames that the page sent, as hex.
fn sent(records: &[Record]) -> Vec<String> {
    let lines = records.iter().filter_map(Record::line);
    let frames = lines.filter_map(|line| match line.kind {
        LineEventKind::Sent { frame, .. } => Some(frame.to_string()),
        _ => None,
    });
    frames.collect()
}

/// Replays the open file, in which a wheel gets to 100 rpm.
fn replay(scenario: &Scenario) -> Result<()> {
    let page = &scenario.page;
    page.click("button", "Disconnect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    page.click("button", "Replay")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Replay"))?;
    look(page, LAPTOP)?;
    let graph = in_sight(page, LAPTOP, "img", "Speed and current")?;
    assert!(graph.height() >= 160.0, "{graph:?}");
    let wheel = in_sight(page, LAPTOP, "img", "Digital twin")?;
    assert!(wheel.height() >= 250.0, "{wheel:?}");
    all_in_sight(page, LAPTOP, &READ_OUTS)?;
    look(page, View::PHONE)?;
    page.evaluate("scrollTo(0, 0)")?;
    let wheel = in_sight(page, View::PHONE, "img", "Digital twin")?;
    for (role, name) in READ_OUTS {
        let card = in_sight(page, View::PHONE, role, name)?;
        assert!(card.top >= wheel.bottom, "{name} at {card:?}, {wheel:?}");
    }
    look(page, View::DESKTOP)?;
    let from_us = now_us();
    page.click("button", "Play")?;
    page.wait_for_text("output", "Speed", |text| {
        number(text).is_some_and(|rpm| (97.0..=103.0).contains(&rpm))
    })?;
    let controls = page.find_all("tablist", "Control")?;
    assert!(controls.is_empty(), "nothing can be driven");
    page.press(" ")?;
    page.find("button", "Play")?;
    ensure!(scenario.since(from_us)?.from_host().frames.is_empty());
    let mut ends = page.find_all("button", "End replay")?;
    ends.pop().context("End replay")?.click()?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    Ok(())
}

#[test]
fn a_session_is_saved_while_it_drives_and_opens_again() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    spin(page, "+100", 97..=103)?;
    page.open_panel("Session file")?;
    let from_us = now_us();
    // Without the browser's dialog, which would cover STOP.
    let saved = page.download("Save session")?;
    page.wait_for_text("status", "Session file", |text| text.contains("Saved"))?;
    let drives = scenario.since(from_us)?.drives();
    let times = drives.frames.iter().map(|frame| frame.at_us);
    let gap_us = times.clone().zip(times.skip(1)).map(|(a, b)| b - a).max();
    assert!(
        gap_us.is_some_and(|gap| gap < GAP_US_MAX),
        "{gap_us:?} us without a frame"
    );
    stop_and_release(page)?;

    assert_eq!(saved.extension(), "mcap");
    let file = saved.bytes()?;
    let in_file = sent(&records(&file)?);
    let wire = scenario.adapter.wire()?.from_host();
    let on_wire: Vec<String> = wire
        .frames
        .iter()
        .map(crate::fixture::exports::hex)
        .collect();
    assert!(in_file.len() > 20, "{} frames", in_file.len());
    assert_eq!(in_file, on_wire[..in_file.len()]);

    page.evaluate(DIALOG)?;
    page.click("button", "Save session")?;
    wait_until("the chosen file", WAIT_MAX, || {
        let bytes: Vec<u8> = serde_json::from_value(page.evaluate(CHOSEN)?)?;
        let frames = records(&bytes).map(|records| sent(&records).len());
        Ok(match frames {
            Ok(frames) if frames >= in_file.len() => Ok(()),
            other => Err(format!("{other:?}")),
        })
    })?;

    page.upload("Open recording", &saved.path)?;
    page.wait_for_text("status", "Session file", |text| text.contains("Opened"))?;
    let content = page.text("region", "Session file")?;
    for text in ["Duration", "0x01", "Connected to"] {
        assert!(content.contains(text), "no {text:?} in {content}");
    }
    replay(&scenario)?;

    let cut = saved.path.with_file_name("cut.mcap");
    fs::write(&cut, &file[..file.len() / 2])?;
    page.upload("Open recording", &cut)?;
    page.wait_for_text("list", "Missing in the file", |text| {
        text.contains("The end of the file is missing")
    })?;
    fs::write(&cut, b"PK\x03\x04 a ZIP archive")?;
    page.upload("Open recording", &cut)?;
    page.wait_for_text("status", "Session file", |text| {
        text.contains("ZIP archive")
    })?;
    assert_quiet_console(page);
    Ok(())
}

#[test]
fn a_bookmark_with_its_note_is_in_the_copy_of_a_session() -> Result<()> {
    let scenario = Scenario::connected(Line::default())?;
    let page = &scenario.page;
    // Without the browser's dialog, which would cover STOP.
    spin(page, "+100", 97..=103)?;
    page.open_panel("Session file")?;
    let saved = page.download("Save session")?;
    stop_and_release(page)?;
    page.click("button", "Disconnect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    // The first screen of somebody who has not seen the tour.
    page.evaluate("localStorage.clear(); true")?;
    page.reload()?;
    page.upload("Open recording", &saved.path)?;
    page.wait_for_text("status", "Session file", |text| text.contains("Opened"))?;
    page.wait_for_text("status", "Connection", |text| text.contains("Replay"))?;
    let tour = page.evaluate("document.querySelector('.tour').checkVisibility()")?;
    assert_eq!(tour, false, "it concerns no recording");
    // It plays at once: at its start nothing is known yet.
    page.wait_for_text("output", "Speed", |text| text.contains('0'))?;
    page.click("button", "Pause replay")?;
    page.click("button", "Add bookmark")?;
    // It ends with Enter, which keeps the note.
    page.fill("textbox", "Note", "gravel starts here")?;

    let copy = page.download("Save copy")?;
    page.upload("Open recording", &copy.path)?;
    // The copy has another name than the file.
    page.wait_for_text("status", "Session file", |text| {
        text.contains("Opened") && text.contains("-bookmarks")
    })?;
    page.wait_for_text("list", "Events", |text| text.contains("gravel starts here"))?;
    assert_quiet_console(page);
    Ok(())
}

/// The samples of each run in a file.
fn samples_of_runs(file: &[u8]) -> Result<Vec<usize>> {
    let session = open(&mut &file[..])??;
    let mut samples = Vec::new();
    for run in session.runs() {
        let range = session.attachment_range(&run.attachment.name);
        let range = range.context("the place of the run")?;
        let bytes = &file[usize::try_from(range.start)?..usize::try_from(range.end)?];
        let (_, record) = Session::read_run(bytes).map_err(|why| anyhow!("{why:?}"))?;
        samples.push(record.samples().len());
    }
    Ok(samples)
}

#[test]
fn a_run_is_in_the_session_and_is_kept_again_from_its_file() -> Result<()> {
    let (scenario, _) = super::runs::running(Line::default())?;
    let page = &scenario.page;
    // The run goes on in another place.
    page.open_panel("Session file")?;
    let saved = page.download("Save session")?;
    page.wait_for_text("status", "Session file", |text| {
        text.contains("Runs of experiments: 1")
    })?;
    stop_and_release(page)?;
    // Three seconds of it were stored, at 200 replies a second.
    let samples = samples_of_runs(&saved.bytes()?)?;
    assert!(
        matches!(samples[..], [samples] if samples > 300),
        "{samples:?}"
    );

    page.open_panel("Experiments")?;
    page.click("tab", "Runs")?;
    let listed = || page.find_all("checkbox", "Mark Back and forth");
    listed()?.pop().context("the run")?.click()?;
    page.click("button", "Delete")?;
    page.click("button", "Delete runs")?;
    wait_until("the run to be deleted", WAIT_MAX, || {
        Ok(if listed()?.is_empty() {
            Ok(())
        } else {
            Err("it is there".to_owned())
        })
    })?;

    page.open_panel("Session file")?;
    page.upload("Open recording", &saved.path)?;
    page.wait_for_text("status", "Session file", |text| text.contains("Opened"))?;
    page.wait_for_text("list", "Runs of experiments", |text| {
        text.contains("Back and forth")
    })?;
    for said in [
        "Runs added to the tab Runs of Experiments: 1.",
        "already in the list: 1.",
    ] {
        page.click("button", "Keep these runs")?;
        page.wait_for_text("status", "Session file", |text| text.contains(said))?;
    }
    page.open_panel("Experiments")?;
    wait_until("the run of the file", WAIT_MAX, || {
        Ok(match listed()?.len() {
            1 => Ok(()),
            other => Err(format!("{other} runs")),
        })
    })?;
    scenario.stays_undriven(Duration::from_secs(1))?;
    assert_quiet_console(page);
    Ok(())
}
