//! The page without a network, at any path, and the next version of it.

use std::fs;
use std::path::{Path, PathBuf};

use crate::fixture::{assert_quiet_console, spin};
use anyhow::{Context, Result};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use end_to_end::{Bench, Page, artefacts, retry, wait_until};
use serde_json::Value;
use sha2::{Digest, Sha256};
use tempfile::TempDir;

/// Where on its host the page may be.
const SUB_PATH: &str = "some/deep/path";

/// A host that has the page in a directory of its own, and can be given the next version.
struct Host {
    dir: TempDir,
}

impl Host {
    fn new() -> Result<Self> {
        let dir = tempfile::tempdir()?;
        fs::write(dir.path().join("index.html"), "another page")?;
        artefacts::copy_site(&artefacts::dist()?, &dir.path().join(SUB_PATH))?;
        Ok(Self { dir })
    }

    fn site(&self) -> PathBuf {
        self.dir.path().join(SUB_PATH)
    }

    /// Another style sheet, by another name, as a build makes it.
    fn publish_next_version(&self) -> Result<()> {
        let site = self.site();
        let style = fs::read_dir(&site)?
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .find(|name| is_style_sheet(name))
            .expect("a style sheet");
        let next = "style-0123456789ab.css";
        let sheet = fs::read_to_string(site.join(&style))?;
        fs::write(
            site.join(next),
            sheet + ":root { --version: \"the next\"; }\n",
        )?;
        fs::remove_file(site.join(&style))?;
        let index = fs::read_to_string(site.join("index.html"))?;
        let next_index = index.replace(&style, next);
        fs::write(site.join("index.html"), &next_index)?;
        let worker = fs::read_to_string(site.join("sw.js"))?;
        let next_worker = worker
            .replace(&style, next)
            .replace(&integrity(&index), &integrity(&next_index))
            .replace(
                "const cacheName = `${ours}",
                "const cacheName = `${ours}next-",
            );
        assert!(next_worker.contains(&integrity(&next_index)));
        fs::write(site.join("sw.js"), next_worker)?;
        Ok(())
    }
}

/// The style sheet itself, and not its compressed copies beside it.
fn is_style_sheet(name: &str) -> bool {
    name.starts_with("style-") && Path::new(name).extension().is_some_and(|ext| ext == "css")
}

fn integrity(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text)))
}

fn drive_virtual_motor(page: &Page) -> Result<()> {
    page.click("button", "Virtual motor")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.wait_for_text("output", "Mode", |text| text.contains("elocity"))?;
    spin(page, "+100", 97..=103)
}

fn disconnect(page: &Page) -> Result<()> {
    page.click("button", "Disconnect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Disconnected"))?;
    Ok(())
}

fn version(page: &Page) -> Result<Value> {
    page.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--version')")
}

/// Has the browser look for a new version, as it does with every visit and every hour. Whether it did: at times
/// this Chromium lets the question lie for as long as the page is there.
fn look_for_new_version(page: &Page) -> Result<bool> {
    let said = page.evaluate(
        "navigator.serviceWorker.getRegistration().then((it) => Promise.race([
            it.update().then(() => 'looked', String),
            new Promise((give) => setTimeout(give, 2_000, 'no answer')),
        ]))",
    )?;
    if said == "no answer" {
        return Ok(false);
    }
    anyhow::ensure!(said == "looked", "looking for a new version: {said}");
    Ok(true)
}

fn notices(page: &Page, wanted: impl Fn(&str) -> bool) -> Result<String> {
    page.wait_for_text("region", "Notices", wanted)
}

const READY: &str = "A new version is ready";

#[test]
fn after_one_visit_the_page_starts_and_drives_without_a_network() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    page.wait_until_kept()?;
    assert_quiet_console(&page);
    bench.stop_serving();
    page.reload()?;
    drive_virtual_motor(&page)?;
    // Others come to it, too.
    let other = bench.open("/?port=virtual")?;
    other.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    Ok(())
}

#[test]
fn the_page_can_be_installed_and_works_at_any_path_without_a_network() -> Result<()> {
    let host = Host::new()?;
    let bench = Bench::serving(host.dir.path())?;
    let page = bench.open(&format!("/{SUB_PATH}/"))?;
    page.wait_until_kept()?;
    let (url, errors) = page.manifest()?;
    assert!(
        url.ends_with(&format!("/{SUB_PATH}/manifest.webmanifest")),
        "{url}"
    );
    assert_eq!(errors, Vec::<Value>::new());
    assert_eq!(page.installability_errors()?, Vec::<Value>::new());
    // The rest of the origin is none of its business.
    page.go(&format!("{}/index.html", bench.origin()))?;
    assert_eq!(
        page.evaluate("document.body.textContent")?,
        Value::from("another page")
    );
    bench.stop_serving();
    page.go(&format!("{}/{SUB_PATH}/index.html", bench.origin()))?;
    drive_virtual_motor(&page)
}

#[test]
fn a_new_version_is_taken_when_the_person_says_so_and_not_while_a_port_is_open() -> Result<()> {
    retry("visit", VISITS_MAX, || {
        Ok(if a_new_version_is_taken()? {
            Ok(())
        } else {
            Err("the browser did not look for a new version".to_owned())
        })
    })
}

const VISITS_MAX: u32 = 8;

/// Whether the browser has looked for it at all.
fn a_new_version_is_taken() -> Result<bool> {
    let host = Host::new()?;
    let bench = Bench::serving(host.dir.path())?;
    let page = bench.open(&format!("/{SUB_PATH}/"))?;
    page.wait_until_kept()?;
    // Connected is enough: a version is offered and taken while no port is open.
    page.click("button", "Virtual motor")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    host.publish_next_version()?;
    if !look_for_new_version(&page)? {
        return Ok(false);
    }
    wait_until("the new version to wait", end_to_end::WAIT_MAX, || {
        let state = page.evaluate(
            "navigator.serviceWorker.getRegistration().then((it) => it.waiting ? 'waits' : `${it.installing?.state} ${it.active?.state}`)",
        )?;
        Ok(if state == "waits" {
            Ok(())
        } else {
            Err(state.to_string())
        })
    })?;
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert!(!page.text("region", "Notices")?.contains(READY));

    disconnect(&page)?;
    notices(&page, |text| text.contains(READY))?;
    // A visit takes nothing by itself.
    page.reload()?;
    notices(&page, |text| text.contains(READY))?;
    assert_eq!(version(&page)?, Value::from(""));
    // It goes with the port and comes again.
    page.click("button", "Virtual motor")?;
    notices(&page, |text| !text.contains(READY))?;
    disconnect(&page)?;
    notices(&page, |text| text.contains(READY))?;

    let other = bench.open(&format!("/{SUB_PATH}/?port=virtual"))?;
    other.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.show()?;
    page.click("button", "Update")?;
    notices(&page, |text| text.contains("Another MotorLink tab"))?;
    // A hidden tab has no accessibility tree.
    let state = other
        .evaluate("document.querySelector('.connection').dataset.state")
        .context("the other tab")?;
    assert_eq!(state, Value::from("Connected"));
    bench.close(other)?;

    page.click("button", "Update")?;
    wait_until("the next version", end_to_end::WAIT_MAX, || {
        // While it loads there is nobody to ask.
        let version = version(&page).unwrap_or_default();
        Ok(if version == "\"the next\"" {
            Ok(())
        } else {
            Err(version.to_string())
        })
    })?;
    wait_until("no more offer", end_to_end::WAIT_MAX, || {
        let offers = page.find_all("button", "Update")?.len();
        Ok((offers == 0)
            .then_some(())
            .ok_or_else(|| format!("{offers} offers")))
    })?;
    let caches = page
        .evaluate("caches.keys().then((names) => names.length)")
        .context("counting caches")?;
    assert_eq!(caches, Value::from(1), "the old one is gone");
    bench.stop_serving();
    page.reload()?;
    drive_virtual_motor(&page)?;
    assert_eq!(version(&page)?, Value::from("\"the next\""));
    Ok(true)
}

#[test]
fn where_the_page_cannot_be_installed_settings_say_why() -> Result<()> {
    let bench = Bench::reuse()?;
    let page = bench.open("/")?;
    page.open_panel("Settings")?;
    let install = page.find("button", "Install")?;
    assert!(
        !install.disabled || install.description.contains("does not offer installation"),
        "{}",
        install.description
    );
    Ok(())
}
