//! The wall clock jumps, as when a machine is told the time or has slept: only in the page and its workers
//! here, never in the machine.

use std::{fs, path::Path, thread, time::Duration};

use crate::fixture::{
    Scenario, assert_quiet_console, connect, number,
    rules::{the_log_has_it_all, the_page_says, the_recording_is_intact, what_is_shown_is_true},
    spin, wait_for_speed,
};
use anyhow::{Context, Result};
use end_to_end::{Bench, Frame, Line, Page, Usb, WAIT_MAX, artefacts, now_us, wait_until};

/// Runs before anything of ours: a message on a channel says how far the wall clock is behind from now on.
/// One that is ahead is what a page sees of a sleep: its monotonic clock stood still.
const CLOCK_THAT_JUMPS: &str = "
    {
        const True = Date;
        let behind_ms = 0;
        globalThis.Date = class extends True {
            constructor(...all) { if (all.length) super(...all); else super(True.now() - behind_ms); }
            static now() { return True.now() - behind_ms; }
        };
        new BroadcastChannel('clock').onmessage = ({ data }) => {
            behind_ms = data;
            new BroadcastChannel('jumped').postMessage(globalThis.name ?? '');
        };
    }
";

/// A copy of the built page whose scripts begin with the clock that jumps.
fn pages_with_the_clock(dir: &Path) -> Result<()> {
    artefacts::copy_site(&artefacts::dist()?, dir)?;
    for file in fs::read_dir(dir)? {
        let file = file?;
        let name = file.file_name();
        let name = name.to_string_lossy();
        let starts = ["page-boot-", "worker-boot-", "tasks-boot-"];
        if starts.iter().any(|start| name.starts_with(start)) && name.ends_with(".js") {
            let content = fs::read(file.path())?;
            fs::write(
                file.path(),
                [CLOCK_THAT_JUMPS.as_bytes(), &content].concat(),
            )?;
        }
    }
    Ok(())
}

/// What the page says of the age of the speed, in seconds: nothing while it is below one second.
fn age_of_speed(page: &Page) -> Result<Option<f64>> {
    Ok(number(&page.find("output", "Speed")?.description))
}

/// A wheel at +100 rpm, driven by a page whose clocks can jump.
fn spinning(dir: &Path) -> Result<Scenario> {
    pages_with_the_clock(dir)?;
    let bench = Bench::serving(dir)?;
    let adapter = bench.plug(Line::default(), Usb::default())?;
    let page = bench.open("/")?;
    connect(&page)?;
    spin(&page, "+100", 97..=103)?;
    Ok(Scenario {
        bench,
        adapter,
        page,
    })
}

/// Lets the wall clocks of the page, of the worker with the port and of the log's worker jump.
fn jump_back(page: &Page, ms: i64) -> Result<()> {
    let told = page.evaluate(&format!(
        "new Promise((told) => {{
            const heard = [];
            const jumped = new BroadcastChannel('jumped');
            jumped.onmessage = ({{ data }}) => {{ heard.push(data); }};
            new BroadcastChannel('clock').postMessage({ms});
            setTimeout(() => told(heard.length), 500);
        }})"
    ))?;
    assert_eq!(told, 3, "clocks that jumped");
    Ok(())
}

/// Whether the graph has an unbroken level line in the past three seconds. That of the target has gaps.
const GRAPH_IS_OF_NOW: &str = "(() => {
    const lines = document.querySelector('.graph-lines');
    const [from, to] = [0.7, 0.9].map((part) => Math.floor(part * lines.width));
    const context = lines.getContext('2d');
    for (let row = 0; row < lines.height; row += 1) {
        const { data } = context.getImageData(from, row, to - from, 1);
        if (data.every((value, place) => place % 4 < 3 || value > 0)) return true;
    }
    return false;
})()";

#[test]
fn a_wall_clock_that_jumps_back_a_day_changes_nothing() -> Result<()> {
    let dir = tempfile::tempdir()?;
    let scenario = spinning(dir.path())?;
    let page = &scenario.page;

    let jumped_us = now_us();
    jump_back(page, 86_400_000)?;
    let before_ms = page.evaluate("performance.timeOrigin + performance.now() - Date.now()")?;
    let behind_ms = before_ms.as_f64().context("a time")?;
    assert!(behind_ms > 86_000_000.0, "{behind_ms} ms behind");

    for _ in 0..20 {
        thread::sleep(Duration::from_millis(100));
        assert!(what_is_shown_is_true(page, 0.0..=110.0)?, "no speed");
        let age_s = age_of_speed(page)?;
        assert!(
            age_s.is_none_or(|age_s| age_s < 2.0),
            "a speed of now is said to be {age_s:?} s old"
        );
    }
    let drives = scenario.since(jumped_us)?.drives();
    let asked = |frame: &Frame| frame.drive_setpoint() == Some(100);
    if !drives.frames.iter().all(asked) {
        // A machine that is held up may lose a motor for 200 ms, whatever its clock.
        the_page_says(page, "no reply for 200 ms")?;
        let its_own = |frame: &Frame| asked(frame) || frame.is_stop();
        assert!(drives.frames.iter().all(its_own), "{drives}");
    }
    assert!(drives.len() > 60, "{} drive frames in 2.5 s", drives.len());
    // What falls silent grows old as ever.
    let mut scenario = scenario;
    scenario.adapter.act("mute 1 on")?;
    wait_until("the last speed to be old", WAIT_MAX, || {
        let age_s = age_of_speed(&scenario.page)?;
        Ok(match age_s {
            Some(age_s) if (2.0..20.0).contains(&age_s) => Ok(()),
            said => Err(format!("{said:?}")),
        })
    })?;
    scenario.adapter.act("mute 1 off")?;
    scenario.page.press("Escape")?;
    wait_for_speed(&scenario.page, 0..=0)?;
    // In order, though the wall clock is not.
    the_log_has_it_all(&scenario, 0)?;
    the_recording_is_intact(&scenario, jumped_us)?;
    assert_quiet_console(&scenario.page);
    Ok(())
}

/// What a page sees when the computer wakes.
#[test]
fn a_computer_that_slept_finds_its_motors_stopped_and_says_why() -> Result<()> {
    const ASLEEP_MS: i64 = 600_000;
    let dir = tempfile::tempdir()?;
    let scenario = spinning(dir.path())?;
    let page = &scenario.page;

    let slept_us = now_us();
    jump_back(page, -ASLEEP_MS)?;
    the_page_says(page, "The computer slept; motors were stopped.")?;
    wait_for_speed(page, 0..=0)?;
    let drives = scenario.since(slept_us)?.drives();
    let behind_the_first_stop = drives.frames.iter().skip_while(|frame| !frame.is_stop());
    assert!(behind_the_first_stop.clone().count() > 0, "{drives}");
    for frame in behind_the_first_stop {
        assert!(frame.is_stop(), "{drives}");
    }
    page.find("alertdialog", "Stopped")?;

    // Nothing is too old, and the log tells the time after the sleep.
    page.click("button", "Release")?;
    spin(page, "+50", 47..=53)?;
    wait_until("the graph to show the new speed", WAIT_MAX, || {
        let is_of_now = page.evaluate(GRAPH_IS_OF_NOW)?;
        Ok((is_of_now == true)
            .then_some(())
            .ok_or_else(|| "it has no line there".to_owned()))
    })?;
    page.press("Escape")?;
    wait_for_speed(page, 0..=0)?;
    let log = the_log_has_it_all(&scenario, 0)?;
    let times = log.column("time")?;
    let last = times.last().context("an empty log")?;
    let behind = page.evaluate(&format!("Date.now() - Date.parse('{last}')"))?;
    let behind_ms = behind.as_f64().context("a time")?;
    assert!(
        behind_ms.abs() < 30_000.0,
        "the log is {behind_ms} ms behind"
    );
    assert_quiet_console(page);
    Ok(())
}
