//! Chromium, headless and unmodified but for the preloaded library.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::{Map, Value, json};

use crate::adapter::Usb;
use crate::artefacts;
use crate::cdp::{Connection, Session, target_ids};
use crate::retry::retry;
use crate::wait::{WAIT_MAX, wait_until};

/// Chromium reads the protocol from file 3 and writes it to file 4; Rust only passes on files 0 to 2.
const WITH_PIPE: &str = r#"exec "$0" "$@" 3<&0 4>&1 </dev/null >&2"#;

/// The flags of a browser without background activity. The usual flags against throttling are missing, because this
/// bench measures how a hidden page is throttled.
const FLAGS: [&str; 19] = [
    "headless=new",
    "remote-debugging-pipe",
    "window-size=1440,900",
    "hide-scrollbars",
    "disable-extensions",
    "disable-gpu",
    "no-first-run",
    "no-default-browser-check",
    "disable-default-apps",
    "mute-audio",
    "password-store=basic",
    // These two load hundreds of scripts at each start, for an address bar that nobody sees.
    "disable-features=WebUIOmniboxPopup,WebUIOmniboxAimPopup",
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

/// The names of all that the origin of a page has stored.
const STORED: &str = "indexedDB.databases().then(databases =>
    [...Object.keys(localStorage), ...databases.map(database => database.name)].join())";

/// Maximal time for the browser to exit, which takes about 0.1 s.
const END_MAX: Duration = Duration::from_secs(5);

/// A running browser; ended when dropped.
pub struct Chromium {
    process: Child,
    connection: Arc<Connection>,
}

impl Chromium {
    /// Starts a browser with a new profile in `profile`. It finds its serial adapters in `udev_dir`, lets `origin`
    /// use the permitted ones, and saves files in `downloads`.
    pub fn start(profile: &Path, udev_dir: &Path, downloads: &Path, origin: &str) -> Result<Self> {
        permit_serial(profile, origin)?;
        // The browser crashed with a segmentation fault in one of many hundred starts.
        let chromium = retry("start Chromium", 2, || {
            let started = Self::launch(profile, udev_dir)?;
            Ok(started.answer().map_err(|error| {
                let said = fs::read_to_string(messages_file(profile)).unwrap_or_default();
                format!("{error:#}; it said: {said}")
            }))
        })?;
        let downloading = json!({ "behavior": "allow", "downloadPath": downloads });
        chromium.call("Browser.setDownloadBehavior", downloading)?;
        Ok(chromium)
    }

    fn launch(profile: &Path, udev_dir: &Path) -> Result<Self> {
        let mut shell = Command::new("sh");
        shell
            .args(["-c", WITH_PIPE])
            .arg(artefacts::chromium()?)
            .args(FLAGS.map(|flag| format!("--{flag}")))
            .arg(format!("--user-data-dir={}", profile.display()))
            // Without an address it would load its own start page.
            .arg("about:blank")
            .env("LD_PRELOAD", artefacts::udev_shim()?)
            .env("MOTORLINK_UDEV_DIR", udev_dir)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(File::create(messages_file(profile))?);
        if rustix::process::geteuid().is_root() {
            shell.arg("--no-sandbox");
        }
        let mut process = shell.spawn().context("no shell that starts Chromium")?;
        let commands = process.stdin.take().context("no pipe to Chromium")?;
        let messages = process.stdout.take().context("no pipe from Chromium")?;
        Ok(Self {
            process,
            connection: Arc::new(Connection::new(commands, messages)),
        })
    }

    /// Itself, as soon as it answers.
    fn answer(self) -> Result<Self> {
        self.call("Browser.getVersion", json!({}))?;
        Ok(self)
    }

    fn call(&self, method: &str, params: Value) -> Result<Value> {
        self.connection.call(None, WAIT_MAX, method, params)
    }

    /// A new empty tab, in front of all others.
    pub fn new_tab(&self) -> Result<Session> {
        Session::new_tab(Arc::clone(&self.connection))
    }

    /// Kills it at once: nothing of it can act any more.
    pub fn kill(&mut self) -> Result<()> {
        self.process.kill()?;
        self.process.wait()?;
        Ok(())
    }

    /// Closes all tabs but an empty one, and deletes what an origin has stored.
    pub fn forget(&self, origin: &str) -> Result<()> {
        let tabs = self.tabs()?;
        let empty = self.new_tab()?;
        for tab in tabs {
            self.close(&tab)?;
        }
        // What a page wrote just before its end can arrive after the deletion.
        retry("delete what was stored", 5, || {
            let all = json!({ "origin": origin, "storageTypes": "all" });
            empty.call("Storage.clearDataForOrigin", all)?;
            empty.load(WAIT_MAX, &format!("{origin}/icon.svg"))?;
            let left = empty.evaluate(STORED)?;
            empty.load(WAIT_MAX, "about:blank")?;
            Ok(match left.as_str() {
                Some("") => Ok(()),
                _ => Err(format!("there is {left}")),
            })
        })
    }

    /// Closes a tab, whatever the page in it does.
    pub fn close(&self, tab: &str) -> Result<()> {
        self.call("Target.closeTarget", json!({ "targetId": tab }))?;
        self.wait_until_closed(tab)
    }

    /// Waits until a tab that was told to close is closed.
    pub fn wait_until_closed(&self, tab: &str) -> Result<()> {
        wait_until("the tab to be gone", WAIT_MAX, || {
            let is_open = self.tabs()?.iter().any(|open| open == tab);
            Ok(if is_open {
                Err("it is open".to_owned())
            } else {
                Ok(())
            })
        })
    }

    /// The IDs of its tabs.
    fn tabs(&self) -> Result<Vec<String>> {
        let pages = json!({ "filter": [{ "type": "page" }] });
        Ok(target_ids(&self.call("Target.getTargets", pages)?))
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        // On request it ends its helper processes first. If it is killed, they run for a second or two and write into
        // a profile that has just been removed.
        let _ = self
            .connection
            .call(None, END_MAX, "Browser.close", json!({}));
        let has_ended = wait_until("its end", END_MAX, || {
            let status = self.process.try_wait()?;
            Ok(status.ok_or_else(|| "it runs".to_owned()))
        });
        if has_ended.is_err() {
            let _ = self.kill();
        }
    }
}

/// What the browser writes to its terminal.
fn messages_file(profile: &Path) -> PathBuf {
    profile.join("messages.txt")
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
