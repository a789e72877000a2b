//! The bench of one test.

use std::cell::{Cell, RefCell};
use std::env;
use std::fs;
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result};
use motorlink_web_server::{Delivery, Server, files};
use rustix::thread::{CapabilitySet, remove_capability_from_bounding_set};
use tempfile::TempDir;

use crate::adapter::{Adapter, Usb};
use crate::artefacts;
use crate::cdp::Session;
use crate::chromium::Chromium;
use crate::line::Line;
use crate::page::Page;
use crate::retry::retry;
use crate::wait::{WAIT_MAX, wait_until};

/// Time to load a page, which takes half a second.
const SOON: Duration = Duration::from_secs(5);

/// A browser, a server of the page, and adapters. Benches are independent, so that tests can run in parallel, in one
/// process or in several.
pub struct Bench {
    // Dropped in this order: the browser before what it uses.
    chromium: Chromium,
    server: RefCell<Option<Server>>,
    origin: String,
    dir: TempDir,
    adapter_count: Cell<usize>,
}

impl Bench {
    /// A bench for the built page.
    ///
    /// # Errors
    ///
    /// When something is not built or installed: the error says what to run.
    pub fn start() -> Result<Self> {
        Self::serving(&artefacts::dist()?)
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
        let mut dir = tempfile::Builder::new().prefix("motorlink-").tempdir()?;
        // Keeps the wire logs and files of a failed scenario.
        dir.disable_cleanup(env::var_os("MOTORLINK_BENCH_KEEP").is_some());
        let udev_dir = udev_dir(dir.path());
        fs::create_dir(&udev_dir)?;
        let server = serve(pages)?;
        let origin = server.origin();
        let profile = dir.path().join("profile");
        let downloads = downloads_dir(dir.path());
        fs::create_dir(&downloads)?;
        let chromium = Chromium::start(&profile, &udev_dir, &downloads, &origin)?;
        Ok(Self {
            chromium,
            server: RefCell::new(Some(server)),
            origin,
            dir,
            adapter_count: Cell::new(0),
        })
    }

    /// Plugs a new adapter, with these motors on its wire.
    ///
    /// # Errors
    ///
    /// When `virtual-motor` is not built or does not start.
    pub fn plug(&self, line: Line, usb: Usb) -> Result<Adapter> {
        let name = format!(
            "adapter-{}",
            self.adapter_count.replace(self.adapter_count.get() + 1)
        );
        let dir = self.dir.path().join(&name);
        fs::create_dir(&dir).with_context(|| format!("no place for {name}"))?;
        let mut adapter = Adapter::new(name, dir, udev_dir(self.dir.path()), line, usb);
        adapter.plug()?;
        Ok(adapter)
    }

    /// Opens a path of the served directory, such as `/?port=virtual`, in a tab in front.
    ///
    /// # Errors
    ///
    /// When it does not load.
    pub fn open(&self, path: &str) -> Result<Page> {
        self.open_url(&format!("{}{path}", self.origin))
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
            tab.blocking()
                .wait("a tab to close", tab.tab().clone().close())?;
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
        wait_until("the tab to be gone", WAIT_MAX, || {
            let open = self.chromium.has_tab(page.tab_id())?;
            Ok(if open {
                Err("it is open".to_owned())
            } else {
                Ok(())
            })
        })
    }

    /// Kills the browser as a system without memory does, and starts it again with what it has kept.
    ///
    /// # Errors
    ///
    /// When it does not start.
    pub fn kill_browser(&mut self) -> Result<()> {
        self.chromium.kill()?;
        let dir = self.dir.path();
        let (profile, downloads) = (dir.join("profile"), downloads_dir(dir));
        self.chromium = Chromium::start(&profile, &udev_dir(dir), &downloads, &self.origin)?;
        Ok(())
    }

    /// Stops the server: from now on the browser is offline.
    pub fn stop_serving(&self) {
        self.server.replace(None);
    }

    /// The origin of the page, without a slash at its end.
    #[must_use]
    pub fn origin(&self) -> String {
        self.origin.clone()
    }

    /// Stops debugging a page, which cannot be used after that.
    pub(crate) fn detach(&self, page: &Page) -> Result<()> {
        self.chromium.detach(page.session.tab())
    }

    pub(crate) fn downloads(&self) -> PathBuf {
        downloads_dir(self.dir.path())
    }

    pub(crate) fn new_tab(&self) -> Result<Session> {
        self.chromium.new_tab()
    }
}

/// Serves the page on a free port of this machine.
fn serve(pages: &Path) -> Result<Server> {
    fs::metadata(pages.join("index.html"))
        .with_context(|| format!("no index.html to serve in {}", pages.display()))?;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).context("no port to serve on")?;
    Ok(Server::start(listener, files(pages, Delivery::Uncached)?)?)
}

fn udev_dir(dir: &Path) -> PathBuf {
    dir.join("udev")
}

fn downloads_dir(dir: &Path) -> PathBuf {
    dir.join("downloads")
}
