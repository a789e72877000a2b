//! Chromium and chromedriver, for the browser tests and the bench.

use std::path::PathBuf;

use anyhow::Result;

use crate::programs;

/// Names under which systems install Chromium.
const CHROMIUM_NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// Names under which systems install its driver.
const DRIVER_NAMES: [&str; 1] = ["chromedriver"];

/// The browser and the program through which tests drive it.
#[derive(Debug)]
pub struct Browser {
    /// Chromium.
    pub chromium: PathBuf,
    /// chromedriver.
    pub driver: PathBuf,
}

/// Finds both, or installs them.
pub fn ensure() -> Result<Browser> {
    programs::ensure(
        find,
        &["chromium", "chromium-driver"],
        "Chromium or chromedriver is missing: install both (Debian: apt-get install chromium \
         chromium-driver) or name them in MOTORLINK_CHROMIUM and CHROMEDRIVER",
    )
}

fn find() -> Result<Option<Browser>> {
    let chromium = programs::look_up("MOTORLINK_CHROMIUM", &CHROMIUM_NAMES)?;
    let driver = programs::look_up("CHROMEDRIVER", &DRIVER_NAMES)?;
    Ok(chromium
        .zip(driver)
        .map(|(chromium, driver)| Browser { chromium, driver }))
}
