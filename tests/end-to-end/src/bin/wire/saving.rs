//! Measures what saving a session costs the motor that is driven meanwhile.

use std::{thread, time::Duration};

use anyhow::{Context, Result, ensure};
use end_to_end::{
    Bench, Line, Page, WireLog,
    figures::{ratio, row, row_without_bound},
    now_us,
};
use serde::Deserialize;

use crate::driving::{SETTLES, connected, spin};

const HERTZ: u16 = 500;
const RUN: Duration = Duration::from_secs(30);
/// The browser answers a call in 20 s.
const CALL: Duration = Duration::from_secs(10);

/// Saves again and again for these seconds. Returns how many saves ended, how long the longest took, and what the page
/// says of the last one. While a motor is driven each file is a download.
const SAVE: &str = "async (seconds) => {
    const named = (name) => [...document.querySelectorAll('button')].find((it) => it.textContent.trim() === name);
    const words = () => document.querySelector('[role=status][aria-label=\"Session file\"]').textContent;
    const tick = () => new Promise((done) => setTimeout(done, 20));
    const ends = performance.now() + seconds * 1000;
    let [saves, longest_ms] = [0, 0];
    while (performance.now() < ends) {
        const began = performance.now();
        named('Save session').click();
        while (named('Save session') && performance.now() - began < 200) await tick();
        while (!named('Save session')) await tick();
        if (!words().includes('Saved')) throw new Error(words());
        longest_ms = Math.max(longest_ms, performance.now() - began);
        saves += 1;
    }
    return { saves, longest_ms, words: words() };
}";

#[derive(Deserialize)]
struct Saved {
    saves: u32,
    longest_ms: f64,
    words: String,
}

pub fn measure(watched: Duration) -> Result<()> {
    let bench = Bench::start()?;
    let (adapter, page) = connected(&bench, Line::default())?;
    keep_run(&page)?;
    page.open_panel("Control")?;
    spin(&page, HERTZ)?;
    page.open_panel("Session file")?;
    page.find("button", "Save session")?;
    page.drop_accessibility_tree()?;
    thread::sleep(SETTLES);
    let passes = (watched.as_secs() / (2 * CALL.as_secs())).max(1);
    let mut without = WireLog::default();
    let mut meanwhile = WireLog::default();
    let (mut saves, mut longest_ms, mut words) = (0, 0.0_f64, String::new());
    // By turns: the log grows, and the machine changes.
    for _ in 0..passes {
        let from = now_us();
        thread::sleep(CALL);
        let until = now_us();
        without.frames.extend(part(&adapter.wire()?, from, until));
        let from = now_us();
        let call = format!("({SAVE})({})", CALL.as_secs());
        let pass: Saved = serde_json::from_value(page.evaluate(&call)?)?;
        let until = now_us();
        meanwhile.frames.extend(part(&adapter.wire()?, from, until));
        saves += pass.saves;
        longest_ms = longest_ms.max(pass.longest_ms);
        words = pass.words;
    }
    ensure!(saves > 0, "nothing was saved");
    ensure!(
        words.contains("Runs of experiments: 1"),
        "no run in it: {words}"
    );
    let p99 = |wire: &WireLog| wire.gaps().map(|gaps| gaps.p99_us).context("no frame");
    let (without, meanwhile) = (p99(&without)?, p99(&meanwhile)?);
    let longer = ratio(meanwhile, without);
    row(
        "gap between drive frames, p99, at the 500 Hz setting while sessions are saved, against without",
        "at most 1.05",
        format!("{longer:.2}: {meanwhile} of {without} us"),
        longer <= 1.05,
    );
    // `Saved motorlink-2026-11-25.mcap: 3.1 MB, 98,000 records. Runs of experiments: 1`
    let content = words.split_once(": ").map_or("", |(_, content)| content);
    row_without_bound(
        "the same: saves one after the other, the longest, the last file",
        format!("{saves} saves, {longest_ms:.0} ms, {content}"),
    );
    crate::ensure_quiet(&page)
}

/// Runs the sequence of the panel for half a minute: each save attaches that run.
fn keep_run(page: &Page) -> Result<()> {
    page.open_panel("Experiments")?;
    thread::sleep(SETTLES);
    crate::runs::run(page)?;
    thread::sleep(RUN);
    page.click("button", "Abort")?;
    page.wait_for_text("status", "Result of the run", |text| !text.is_empty())?;
    Ok(())
}

/// The drive frames of this time.
fn part(wire: &WireLog, from: u64, until: u64) -> Vec<end_to_end::Frame> {
    wire.since(from).until(until).drives().frames
}
