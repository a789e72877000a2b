//! Chromium, headless and unmodified but for the preloaded library.

use std::path::Path;
use std::time::Duration;
use std::{fs, io};

use anyhow::{Context, Result, anyhow};
use chromiumoxide::browser::{Browser, BrowserConfig};
use chromiumoxide::cdp::browser_protocol::browser::{
    SetDownloadBehaviorBehavior, SetDownloadBehaviorParams,
};
use chromiumoxide::cdp::browser_protocol::target::{
    CloseTargetParams, CreateTargetParams, DetachFromTargetParams, TargetId,
};
use futures::StreamExt;
use serde_json::{Map, Value, json};

use crate::adapter::Usb;
use crate::artefacts;
use crate::cdp::{Blocking, Session};
use crate::retry::retry;
use crate::wait::{WAIT_MAX, wait_until};

/// The flags of a browser without background activity. The usual flags against throttling are missing, because this
/// bench measures how a hidden page is throttled.
const FLAGS: [&str; 13] = [
    "disable-gpu",
    "no-first-run",
    "no-default-browser-check",
    "disable-default-apps",
    "mute-audio",
    "password-store=basic",
    // Without a network it would wait for one at every start.
    "disable-background-networking",
    "disable-component-update",
    "disable-domain-reliability",
    "disable-sync",
    "disable-quic",
    // /dev/shm is tiny in containers.
    "disable-dev-shm-usage",
    // Crashes of the browser must be visible here, not collected.
    "disable-breakpad",
];

/// Maximal time for the browser to exit, which takes about 0.1 s.
const END_MAX: Duration = Duration::from_secs(5);

/// A running browser; killed when dropped.
pub struct Chromium {
    // The browser must be dropped before the thread that ends it.
    browser: Browser,
    blocking: Blocking,
    /// The ID of the browser's first process.
    pub process_id: u32,
}

impl Chromium {
    /// Starts a browser with a new profile in `profile`. It finds its serial adapters in `udev_dir`, lets `origin`
    /// use the permitted ones, and saves files in `downloads`.
    pub fn start(profile: &Path, udev_dir: &Path, downloads: &Path, origin: &str) -> Result<Self> {
        permit_serial(profile, origin)?;
        let shim = artefacts::udev_shim()?;
        let blocking = Blocking::new()?;
        let mut config = BrowserConfig::builder()
            .chrome_executable(artefacts::chromium()?)
            .new_headless_mode()
            .disable_default_args()
            .args(FLAGS)
            .user_data_dir(profile)
            .window_size(1440, 900)
            .viewport(None)
            .launch_timeout(WAIT_MAX)
            .env("LD_PRELOAD", shim.to_string_lossy())
            .env("MOTORLINK_UDEV_DIR", udev_dir.to_string_lossy());
        if rustix::process::geteuid().is_root() {
            config = config.no_sandbox();
        }
        let config = config.build().map_err(|error| anyhow!(error))?;
        // The browser crashed with a segmentation fault in one of many hundred starts.
        let (mut browser, mut connection) = retry("start Chromium", 2, || {
            let launched = blocking.wait("start", Browser::launch(config.clone()));
            Ok(launched.map_err(|error| format!("{error:#}")))
        })?;
        blocking.spawn(async move {
            // chromiumoxide reports an unknown event as an error; it is harmless here.
            while connection.next().await.is_some() {}
        });
        let downloading = SetDownloadBehaviorParams {
            download_path: Some(downloads.to_string_lossy().into_owned()),
            ..SetDownloadBehaviorParams::new(SetDownloadBehaviorBehavior::Allow)
        };
        blocking.wait("a place for files", browser.execute(downloading))?;
        let process = browser.get_mut_child();
        let process_id = process.and_then(|process| process.inner.id());
        Ok(Self {
            browser,
            blocking,
            process_id: process_id.context("the browser has ended")?,
        })
    }

    /// A new empty tab, in front of all others.
    pub fn new_tab(&self) -> Result<Session> {
        let blank = CreateTargetParams::new("about:blank");
        let tab = self
            .blocking
            .wait("a new tab", self.browser.new_page(blank))?;
        Ok(Session::new(self.blocking.clone(), tab))
    }

    /// Detaches the debugger from a tab.
    pub fn detach(&self, tab: &chromiumoxide::Page) -> Result<()> {
        let params = DetachFromTargetParams::builder()
            .session_id(tab.session_id().clone())
            .build();
        self.blocking
            .wait("to be left alone", self.browser.execute(params))
            .map(drop)
    }

    /// Kills it at once: nothing of it can act any more.
    pub fn kill(&mut self) -> Result<()> {
        let Self {
            browser, blocking, ..
        } = self;
        blocking.wait("its end", async { browser.kill().await.unwrap_or(Ok(())) })?;
        Ok(())
    }

    /// Closes all tabs but an empty one, and deletes what an origin has stored.
    pub fn forget(&self, origin: &str) -> Result<()> {
        let Self {
            browser, blocking, ..
        } = self;
        let tabs = blocking.wait("the list of tabs", browser.pages())?;
        let empty = self.new_tab()?;
        for tab in tabs {
            let close = CloseTargetParams::new(tab.target_id().clone());
            blocking.wait("a tab to close", browser.execute(close))?;
            self.wait_until_closed(tab.target_id())?;
        }
        let all = json!({ "origin": origin, "storageTypes": "all" });
        empty.call("Storage.clearDataForOrigin", all).map(drop)
    }

    /// Waits until a tab that was told to close is closed.
    pub fn wait_until_closed(&self, id: &TargetId) -> Result<()> {
        wait_until("the tab to be gone", WAIT_MAX, || {
            let tabs = self.browser.pages();
            let tabs = self.blocking.wait("the list of tabs", tabs)?;
            let is_open = tabs.iter().any(|tab| tab.target_id() == id);
            Ok(if is_open {
                Err("it is open".to_owned())
            } else {
                Ok(())
            })
        })
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        // On request it ends its helper processes first. If it is killed, they run for a second or two and write into
        // a profile that has just been removed.
        let Self {
            browser, blocking, ..
        } = self;
        let asked = blocking.wait_for("its end", END_MAX, async {
            browser.close().await.map_err(io::Error::other)?;
            browser.wait().await
        });
        if asked.is_err() {
            let _ = blocking.wait("its end", async { browser.kill().await.unwrap_or(Ok(())) });
        }
    }
}

/// Writes a profile in which `origin` can use the permitted adapters, as if the user had picked each of them once.
///
/// A managed policy would work too, but it needs root and a file in /etc that all tests on the machine share, and it
/// permits either all adapters or none.
fn permit_serial(profile: &Path, origin: &str) -> Result<()> {
    let adapters: Vec<Value> = Usb::PERMITTED
        .iter()
        .map(|&(vendor, product)| {
            json!({
                "name": "USB Serial",
                "vendor_id": vendor,
                "product_id": product,
                "serial_number": Usb::SERIAL_PERMITTED,
            })
        })
        .collect();
    let grant = json!({ "setting": { "chosen-objects": adapters } });
    let exceptions: Map<String, Value> = [(format!("{origin},*"), grant)].into_iter().collect();
    let preferences = json!({
        "profile": { "content_settings": { "exceptions": { "serial_chooser_data": exceptions } } },
    });
    let dir = profile.join("Default");
    fs::create_dir_all(&dir).with_context(|| format!("no profile in {}", profile.display()))?;
    fs::write(dir.join("Preferences"), preferences.to_string())?;
    // This allows chrome://discards to be opened.
    let local_state = json!({ "internal_only_uis_enabled": true });
    fs::write(profile.join("Local State"), local_state.to_string())?;
    Ok(())
}
