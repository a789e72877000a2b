//! The rules that hold whatever fails, each a function by its name.

use std::{thread, time::Duration};

use anyhow::{Result, ensure};
use end_to_end::{Frame, PATIENCE, Page, WireLog, now_us, wait_until};

use super::{
    Story,
    exports::{Table, hex, ms_of_day},
    number, spin,
};

/// What a motor that nobody asks for anything may do unseen: a second.
const WATCHED: Duration = Duration::from_secs(1);

/// A page that hangs has its motors stopped within a second; as much again as other stories allow for the
/// machine.
const HUNG_MAX_US: u64 = 1_400_000;

/// What the page says where a motor was lost for a moment: as it drove, or when it was to.
pub const LOST: [&str; 2] = [
    "no reply for 200 ms",
    "has not replied, so its loop is unknown",
];

/// Frames may be written to an adapter that is just being pulled out: those of a write each, behind one
/// that waits.
const LOST_IN_A_PULL: usize = 3;

/// Whether a frame asks for telemetry, or who is there.
fn only_asks(frame: &Frame) -> bool {
    matches!(*frame.bytes.as_slice(), [_, 0x74, ..] | [0xC8, 0x64, ..])
}

/// Nothing but questions was sent since a moment, and for a second from now.
pub fn nothing_moves_until_asked(story: &Story, since_us: u64) -> Result<()> {
    thread::sleep(WATCHED);
    let host = story.since(since_us)?.from_host();
    ensure!(
        host.frames.iter().all(only_asks),
        "sent by nobody's command:\n{host}"
    );
    Ok(())
}

/// Since a moment nobody was driven but to a standstill.
pub fn nothing_but_stops_and_questions(wire: &WireLog) -> Result<()> {
    let host = wire.from_host();
    let stops = |frame: &Frame| frame.is_stop() || !frame.is_drive();
    ensure!(
        host.frames.iter().all(stops),
        "driven by nobody's command:\n{host}"
    );
    Ok(())
}

/// A person starts the wheel, and it turns.
pub fn it_drives_again_when_asked(page: &Page) -> Result<()> {
    page.click("tab", "Velocity")?;
    spin(page, "+50", 47..=53)
}

/// The page says this somewhere, in these words.
pub fn the_page_says(page: &Page, words: &str) -> Result<()> {
    the_page_says_one_of(page, &[words])
}

/// The page says one of these somewhere.
pub fn the_page_says_one_of(page: &Page, words: &[&str]) -> Result<()> {
    wait_until(&format!("the page to say {words:?}"), PATIENCE, || {
        let said = page.evaluate("document.body.innerText")?;
        let said = said.as_str().unwrap_or_default().to_owned();
        Ok(if words.iter().any(|words| said.contains(words)) {
            Ok(())
        } else {
            Err(said)
        })
    })
}

/// The line falls silent: no host speaks for a page that is gone. Until then nothing drives for longer
/// than a page may hang.
pub fn frames_cease(story: &Story, gone_us: u64) -> Result<()> {
    wait_until("a second without a frame", PATIENCE, || {
        let from_us = now_us();
        thread::sleep(WATCHED);
        let host = story.since(from_us)?.from_host();
        Ok(if host.is_empty() {
            Ok(())
        } else {
            Err(host.to_string())
        })
    })?;
    nothing_but_stops_and_questions(&story.since(gone_us + HUNG_MAX_US)?)
}

/// By its own firmware the motor is not driven any more, whatever it was sent.
pub fn the_motor_coasts(story: &mut Story) -> Result<()> {
    let state = story.adapter.act("state 1")?;
    ensure!(state.contains("driven=false"), "{state}");
    Ok(())
}

/// Every frame of the host is in the log, in its order and in order of time; of what was written while
/// the adapter was pulled out so many times a little more.
pub fn the_log_has_it_all(story: &Story, pulls: usize) -> Result<Table> {
    let wire = story.adapter.wire()?;
    // What is on the wire now is in the recorder soon.
    thread::sleep(Duration::from_millis(500));
    let passed_us = now_us();
    let table = Table::read(&story.page.download("Export CSV")?)?;
    let times = table.column("time")?;
    let times: Vec<u64> = times.into_iter().map(ms_of_day).collect::<Result<_>>()?;
    ensure!(times.is_sorted(), "the log is out of order");
    let said = table.column("direction")?;
    let lines = said.into_iter().zip(table.column("hex")?);
    let mut logged = lines.filter(|(said, _)| *said == "TX").map(|(_, hex)| hex);
    let mut unsent = 0;
    let mut last_unsent = String::new();
    for frame in &wire.from_host().frames {
        let hex = hex(frame);
        loop {
            match logged.next() {
                Some(next) if next == hex => break,
                Some(next) => {
                    unsent += 1;
                    last_unsent = format!("{next} before {hex} at {} us", frame.at_us);
                }
                None => anyhow::bail!("not in the log: {hex}, {} us ago", passed_us - frame.at_us),
            }
        }
    }
    ensure!(
        unsent <= LOST_IN_A_PULL * pulls,
        "{unsent} frames in the log were never on the wire, at last {last_unsent}"
    );
    Ok(table)
}

/// The recording, which always runs, holds replies from both before and after a moment, and nothing but
/// what motors said.
pub fn the_recording_is_intact(story: &Story, around_us: u64) -> Result<()> {
    let table = Table::read(&story.page.download("Export telemetry CSV")?)?;
    let wire = story.adapter.wire()?.from_motors();
    let before = wire.until(around_us).len();
    let mut spoken = wire.frames.iter().map(hex).enumerate();
    let (mut old, mut new) = (0, 0);
    for reply in table.column("raw_hex")? {
        let place = spoken.find(|(_, hex)| hex == reply).map(|(place, _)| place);
        match place {
            Some(place) if place < before => old += 1,
            Some(_) => new += 1,
            None => anyhow::bail!("recorded, but by no motor said: {reply}"),
        }
    }
    ensure!(old > 0 && new > 0, "{old} replies before, {new} after");
    Ok(())
}

/// Whether what the page shows can be true of a motor that turns between these speeds; what it does not
/// know it may not show.
pub fn what_is_shown_is_true(page: &Page, rpm: std::ops::RangeInclusive<f64>) -> Result<()> {
    let shown = |name: &str| -> Result<Option<f64>> { Ok(number(&page.text("output", name)?)) };
    if let Some(speed) = shown("Speed")? {
        ensure!(rpm.contains(&speed), "{speed} rpm is shown");
    }
    if let Some(celsius) = shown("Temperature")? {
        ensure!((15.0..60.0).contains(&celsius), "{celsius} deg C is shown");
    }
    if let Some(current) = shown("Current")? {
        ensure!(current.abs() < 1.5, "{current} A is shown");
    }
    Ok(())
}
