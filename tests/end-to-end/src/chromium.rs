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
    CreateTargetParams, DetachFromTargetParams, TargetId,
};
use futures::StreamExt;
use serde_json::{Map, Value, json};

use crate::adapter::Usb;
use crate::artefacts;
use crate::cdp::{Blocking, Session};
use crate::retry::retry;
use crate::wait::WAIT_MAX;

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
        let (browser, mut connection) = retry("start Chromium", 2, || {
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
        Ok(Self { browser, blocking })
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
        let Self { browser, blocking } = self;
        blocking.wait("its end", async { browser.kill().await.unwrap_or(Ok(())) })?;
        Ok(())
    }

    /// Whether this tab is open.
    pub fn has_tab(&self, id: &TargetId) -> Result<bool> {
        let tabs = self
            .blocking
            .wait("the list of tabs", self.browser.pages())?;
        Ok(tabs.iter().any(|tab| tab.target_id() == id))
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        // On request it ends its helper processes first. If it is killed, they run for a second or two and write into
        // a profile that has just been removed.
        let Self { browser, blocking } = self;
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
