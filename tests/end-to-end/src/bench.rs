//! The bench of one test.

use std::cell::Cell;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result};
use motorlink_web_server::Delivery;
use rustix::thread::{CapabilitySet, remove_capability_from_bounding_set};
use tempfile::TempDir;

use crate::adapter::{Adapter, Usb};
use crate::artefacts;
use crate::cdp::Session;
use crate::equipment::{self, Equipment};
use crate::line::Line;
use crate::page::Page;
use crate::retry::retry;
use crate::wait::WAIT_MAX;

/// Time to load a page, which takes half a second.
const SOON: Duration = Duration::from_secs(5);

/// A browser, a server of the page, and adapters. Benches are independent, so that tests can run in parallel, in one
/// process or in several.
pub struct Bench {
    equipment: Arc<Equipment>,
    /// Whether the next bench can have the same browser.
    is_reusable: Cell<bool>,
    adapters: TempDir,
    adapter_count: Cell<usize>,
}

impl Bench {
    /// A bench for the built page, with a new browser.
    ///
    /// # Errors
    ///
    /// When something is not built or installed: the error says what to run.
    pub fn start() -> Result<Self> {
        Self::serving(&artefacts::dist()?)
    }

    /// The same, and the page is sent compressed, as a host does: for what depends on the time of a download.
    ///
    /// # Errors
    ///
    /// As for [`Bench::start`].
    pub fn start_compressed() -> Result<Self> {
        let pages = artefacts::dist()?;
        let equipment = Equipment::start(&pages, Delivery::AsAHost, keeps_files())?;
        Self::with(Arc::new(equipment), false)
    }

    /// A bench for the built page, whose browser an earlier test may have used: its tabs are closed, and what it had
    /// stored is deleted.
    ///
    /// # Errors
    ///
    /// As for [`Bench::start`].
    pub fn reuse() -> Result<Self> {
        let used = equipment::idle().pop();
        let new = || {
            let pages = artefacts::dist()?;
            Equipment::start(&pages, Delivery::Uncached, keeps_files()).map(Arc::new)
        };
        Self::with(used.map_or_else(new, Ok)?, !keeps_files())
    }

    /// A bench whose browser has only the rights of a user, so it cannot open a port that another program has opened
    /// exclusively. A port that it has opened once stays closed to it afterwards, because the program at the other
    /// end keeps the terminal, and the terminal keeps its exclusive owner.
    ///
    /// # Errors
    ///
    /// As for [`Bench::start`].
    pub fn start_as_user() -> Result<Self> {
        if rustix::process::geteuid().is_root() {
            // This applies to this thread and its children, so to the browser.
            remove_capability_from_bounding_set(CapabilitySet::SYS_ADMIN)?;
        }
        Self::start()
    }

    /// A bench for the page in another directory.
    ///
    /// # Errors
    ///
    /// As for [`Bench::start`].
    pub fn serving(pages: &Path) -> Result<Self> {
        let equipment = Equipment::start(pages, Delivery::Uncached, keeps_files())?;
        Self::with(Arc::new(equipment), false)
    }

    fn with(equipment: Arc<Equipment>, is_reusable: bool) -> Result<Self> {
        let mut adapters = tempfile::Builder::new().prefix("motorlink-").tempdir()?;
        adapters.disable_cleanup(keeps_files());
        Ok(Self {
            equipment,
            is_reusable: Cell::new(is_reusable),
            adapters,
            adapter_count: Cell::new(0),
        })
    }

    /// Plugs a new adapter, with these motors on its wire.
    ///
    /// # Errors
    ///
    /// When the command `motorlink` is not built or does not start.
    pub fn plug(&self, line: Line, usb: Usb) -> Result<Adapter> {
        let name = format!(
            "adapter-{}",
            self.adapter_count.replace(self.adapter_count.get() + 1)
        );
        let dir = self.adapters.path().join(&name);
        fs::create_dir(&dir).with_context(|| format!("no place for {name}"))?;
        let mut adapter = Adapter::new(name, dir, self.equipment.udev_dir(), line, usb);
        adapter.plug()?;
        Ok(adapter)
    }

    /// Opens a path of the served directory, such as `/?port=virtual`, in a tab in front.
    ///
    /// # Errors
    ///
    /// When it does not load.
    pub fn open(&self, path: &str) -> Result<Page> {
        self.open_url(&format!("{}{path}", self.origin()))
    }

    /// Opens an empty tab in front.
    pub(crate) fn open_blank(&self) -> Result<Page> {
        self.open_url("about:blank")
    }

    fn open_url(&self, url: &str) -> Result<Page> {
        let mut wait_max = SOON;
        retry(&format!("open {url}"), 2, || {
            let tab = self.new_tab()?;
            let error = match Page::load_within(wait_max, tab.clone(), url, self.downloads()) {
                Ok(page) => return Ok(Ok(page)),
                Err(error) => error,
            };
            // After a crash Chromium may assign the new tab to the process that is ending. On a busy machine it
            // sometimes does not report that a page was loaded. A second tab works.
            self.equipment.chromium.close(tab.target())?;
            wait_max = WAIT_MAX;
            Ok(Err(format!("{error:#}")))
        })
    }

    /// Hides a page as a user does, with a new tab in front of it. [`Page::show`] brings it back.
    ///
    /// # Errors
    ///
    /// When the page does not become hidden.
    pub fn hide(&self, page: &Page) -> Result<()> {
        self.new_tab()?;
        page.wait_for_visibility("hidden")
    }

    /// Closes a page's tab as a user does, with a `pagehide` event, and waits until it is closed.
    ///
    /// # Errors
    ///
    /// When it stays.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a closed page must not be used again"
    )]
    pub fn close(&self, page: Page) -> Result<()> {
        page.close()?;
        self.equipment.chromium.wait_until_closed(page.tab_id())
    }

    /// Kills the browser as a system without memory does, and starts it again with what it has kept.
    ///
    /// # Errors
    ///
    /// When it does not start.
    pub fn kill_browser(&mut self) -> Result<()> {
        self.is_reusable.set(false);
        let equipment = Arc::get_mut(&mut self.equipment);
        equipment.context("another bench has it")?.kill_browser()
    }

    /// Stops the server: from now on the browser is offline.
    pub fn stop_serving(&self) {
        self.is_reusable.set(false);
        self.equipment.stop_serving();
    }

    /// The origin of the page, without a slash at its end.
    #[must_use]
    pub fn origin(&self) -> String {
        self.equipment.origin.clone()
    }

    /// Stops debugging a page, which cannot be used after that.
    pub(crate) fn detach(&self, page: &Page) -> Result<()> {
        self.is_reusable.set(false);
        page.session.detach()
    }

    pub(crate) fn downloads(&self) -> PathBuf {
        self.equipment.downloads()
    }

    pub(crate) fn new_tab(&self) -> Result<Session> {
        self.equipment.chromium.new_tab()
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        // A test that panicked may have left it in any state.
        if self.is_reusable.get() && !thread::panicking() && self.equipment.clear().is_ok() {
            equipment::idle().push(Arc::clone(&self.equipment));
        }
    }
}

/// Whether to keep the wire logs and files of a failed scenario.
fn keeps_files() -> bool {
    env::var_os("MOTORLINK_BENCH_KEEP").is_some()
}
