//! Parts of the page that do not arrive.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::fixture::{spin, wait_for_speed};
use anyhow::{Context, Result};
use end_to_end::{Bench, WAIT_MAX, artefacts, wait_until};
use serde_json::Value;

/// What stands in the place of the packet log.
const IN_PLACE: &str = "document.querySelector('.packet-log .part-missing p')?.textContent ?? ''";

/// The file of a part, by the start of its name.
fn part(site: &Path, start: &str) -> Result<PathBuf> {
    let paths = fs::read_dir(site)?.filter_map(|entry| Some(entry.ok()?.path()));
    let mut parts = paths.filter(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with(start) && name.ends_with(".wasm")
    });
    parts.next().with_context(|| format!("no part {start}"))
}

#[test]
fn a_part_that_is_missing_says_so_in_its_place_and_comes_when_it_is_tried_again() -> Result<()> {
    let site = tempfile::tempdir()?;
    artefacts::copy_site(&artefacts::dist()?, site.path())?;
    let part = part(site.path(), "desk-")?;
    let away = site.path().join("away");
    fs::rename(&part, &away)?;

    let bench = Bench::serving(site.path())?;
    let page = bench.open("/?port=virtual")?;
    wait_until("the missing part to be named", WAIT_MAX, || {
        let text = page.evaluate(IN_PLACE)?;
        let says = text
            .as_str()
            .is_some_and(|text| text.contains("could not be loaded"));
        Ok(if says { Ok(()) } else { Err(text.to_string()) })
    })?;
    // Driving and STOP need no part.
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    spin(&page, "+100", 97..=103)?;
    page.press("Escape")?;
    wait_for_speed(&page, 0..=0)?;
    page.click("button", "Release")?;

    fs::rename(&away, &part)?;
    page.evaluate("document.querySelector('.packet-log .part-missing button').click()")?;
    page.wait_for_text("log", "Packets", |text| text.contains("drive, brake"))?;
    assert_eq!(page.evaluate(IN_PLACE)?, Value::from(""));
    Ok(())
}

#[test]
fn a_run_whose_part_is_missing_is_refused_and_armed_when_it_is_tried_again() -> Result<()> {
    let site = tempfile::tempdir()?;
    artefacts::copy_site(&artefacts::dist()?, site.path())?;
    let part = part(site.path(), "tasks_runs-")?;
    let away = site.path().join("away");
    fs::rename(&part, &away)?;

    let bench = Bench::serving(site.path())?;
    let page = bench.open("/?port=virtual")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.open_panel("Experiments")?;
    page.click("button", "Arm")?;
    page.wait_for_text("status", "Result of the run", |text| {
        text.contains("has failed")
    })?;
    // The port worker goes on.
    spin(&page, "+100", 97..=103)?;
    page.press("Escape")?;
    wait_for_speed(&page, 0..=0)?;
    page.click("button", "Release")?;

    fs::rename(&away, &part)?;
    page.open_panel("Experiments")?;
    page.click("button", "Arm")?;
    page.wait_for_text("status", "Run", |text| text.contains("Armed"))?;
    Ok(())
}
