//! Parts of the page that do not arrive.

use std::{fs, path::PathBuf};

use crate::fixture::{spin, wait_for_speed};
use anyhow::{Context, Result};
use end_to_end::{Bench, Page, WAIT_MAX, artefacts, wait_until};
use serde_json::Value;
use tempfile::TempDir;

/// What stands in the place of the packet log.
const IN_PLACE: &str = "document.querySelector('.packet-log .part-missing p')?.textContent ?? ''";

/// A site without one of its parts.
struct SiteWithoutPart {
    site: TempDir,
    part: PathBuf,
    away: PathBuf,
}

impl SiteWithoutPart {
    /// Without the part whose file starts with this.
    fn new(start: &str) -> Result<Self> {
        let site = tempfile::tempdir()?;
        artefacts::copy_site(&artefacts::dist()?, site.path())?;
        let paths = fs::read_dir(site.path())?.filter_map(|entry| Some(entry.ok()?.path()));
        let mut parts = paths.filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with(start) && name.ends_with(".wasm")
        });
        let part = parts.next().with_context(|| format!("no part {start}"))?;
        let away = site.path().join("away");
        fs::rename(&part, &away)?;
        Ok(Self { site, part, away })
    }

    fn put_back(&self) -> Result<()> {
        Ok(fs::rename(&self.away, &self.part)?)
    }
}

/// Driving and STOP need no part.
fn drives_and_stops(page: &Page) -> Result<()> {
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    spin(page, "+100", 97..=103)?;
    page.press("Escape")?;
    wait_for_speed(page, 0..=0)?;
    page.click("button", "Release")
}

#[test]
fn a_part_that_is_missing_says_so_in_its_place_and_comes_when_it_is_tried_again() -> Result<()> {
    let without_desk = SiteWithoutPart::new("desk-")?;
    let bench = Bench::serving(without_desk.site.path())?;
    let page = bench.open("/?port=virtual")?;
    wait_until("the missing part to be named", WAIT_MAX, || {
        let text = page.evaluate(IN_PLACE)?;
        let says = text
            .as_str()
            .is_some_and(|text| text.contains("could not be loaded"));
        Ok(if says { Ok(()) } else { Err(text.to_string()) })
    })?;
    drives_and_stops(&page)?;

    without_desk.put_back()?;
    page.evaluate("document.querySelector('.packet-log .part-missing button').click()")?;
    page.wait_for_text("log", "Packets", |text| text.contains("drive, brake"))?;
    assert_eq!(page.evaluate(IN_PLACE)?, Value::from(""));
    Ok(())
}

#[test]
fn a_run_whose_part_is_missing_is_refused_and_armed_when_it_is_tried_again() -> Result<()> {
    let without_runs = SiteWithoutPart::new("tasks_runs-")?;
    let bench = Bench::serving(without_runs.site.path())?;
    let page = bench.open("/?port=virtual")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.open_panel("Experiments")?;
    page.click("button", "Arm")?;
    page.wait_for_text("status", "Result of the run", |text| {
        text.contains("has failed")
    })?;
    drives_and_stops(&page)?;

    without_runs.put_back()?;
    page.open_panel("Experiments")?;
    page.click("button", "Arm")?;
    page.wait_for_text("status", "Run", |text| text.contains("Armed"))?;
    Ok(())
}
