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

/// The flags of a quiet browser. None of those that tests usually add against throttling: how a
/// hidden page is throttled is one of the things that this bench measures.
const FLAGS: [&str; 13] = [
    "disable-gpu",
    "no-first-run",
    "no-default-browser-check",
    "disable-default-apps",
    "mute-audio",
    "password-store=basic",
    // There may be no network, and then it would wait for one at every start.
    "disable-background-networking",
    "disable-component-update",
    "disable-domain-reliability",
    "disable-sync",
    "disable-quic",
    // /dev/shm is tiny in containers.
    "disable-dev-shm-usage",
    // Crashes of the browser are to be seen here, not collected.
    "disable-breakpad",
];

/// Longest time for the browser to end by itself, which takes some 0.1 s.
const END_MAX: Duration = Duration::from_secs(5);

/// A running browser; killed when dropped.
pub struct Chromium {
    // The browser must go before the thread that ends it.
    browser: Browser,
    blocking: Blocking,
}

impl Chromium {
    /// Starts a browser with a fresh profile in `profile`, that finds its serial adapters in
    /// `udev_dir`, lets `origin` use the permitted ones, and puts files into `downloads`.
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
        // Seen once in many hundred starts: a segmentation fault of the browser while it starts.
        let (browser, mut connection) = retry("start Chromium", 2, || {
            let launched = blocking.wait("start", Browser::launch(config.clone()));
            Ok(launched.map_err(|error| format!("{error:#}")))
        })?;
        blocking.spawn(async move {
            // An event that chromiumoxide does not know is an error here, but not to us.
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

    /// Lets go of a tab as if nobody had ever debugged it.
    pub fn detach(&self, tab: &chromiumoxide::Page) -> Result<()> {
        let params = DetachFromTargetParams::builder()
            .session_id(tab.session_id().clone())
            .build();
        self.blocking
            .wait("to be left alone", self.browser.execute(params))
            .map(drop)
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
        // Asked to end, it ends its helpers first. Killed, it leaves them behind for a second or
        // two, in which they write into a profile that has just been removed.
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

/// Writes a profile in which `origin` may use the permitted adapters, as if a person had picked
/// each of them once.
///
/// A managed policy would do too, but needs root, a file in /etc that all tests on the machine
/// share, and permits either all adapters or none.
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
    // Lets chrome://discards be opened.
    let local_state = json!({ "internal_only_uis_enabled": true });
    fs::write(profile.join("Local State"), local_state.to_string())?;
    Ok(())
}
