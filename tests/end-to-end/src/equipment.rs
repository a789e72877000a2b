//! What a bench uses and a later bench can use again: a browser, the server of its page, and their directories.
//!
//! To start a browser takes 2.5 s of processor time, half of what a scenario needs before it does anything.

use std::fs;
use std::net::{Ipv4Addr, TcpListener};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use anyhow::{Context, Result};
use motorlink_web_server::{Delivery, Server, files};
use tempfile::TempDir;

use crate::chromium::Chromium;

/// Equipment for the built page that no bench uses now.
static IDLE: Mutex<Vec<Arc<Equipment>>> = Mutex::new(Vec::new());

/// A browser, the server of its page, and their directories.
pub struct Equipment {
    // Dropped in this order: the browser before what it uses.
    pub chromium: Chromium,
    /// `None` once the browser is offline.
    server: Mutex<Option<Server>>,
    pub origin: String,
    dir: TempDir,
    cleaner: OnceLock<Cleaner>,
}

impl Equipment {
    /// Starts a browser with a new profile, for the page in `pages`.
    pub fn start(pages: &Path, delivery: Delivery, keeps_files: bool) -> Result<Self> {
        let mut dir = tempfile::Builder::new().prefix("motorlink-").tempdir()?;
        dir.disable_cleanup(keeps_files);
        let server = serve(pages, delivery)?;
        let origin = server.origin();
        fs::create_dir(udev_dir(dir.path()))?;
        fs::create_dir(downloads_dir(dir.path()))?;
        let chromium = start_browser(dir.path(), &origin)?;
        Ok(Self {
            chromium,
            server: Mutex::new(Some(server)),
            origin,
            dir,
            cleaner: OnceLock::new(),
        })
    }

    /// Takes away all that a bench left.
    pub fn clear(&self) -> Result<()> {
        self.chromium.forget(&self.origin)?;
        for dir in [self.udev_dir(), self.downloads()] {
            for file in fs::read_dir(dir)? {
                fs::remove_file(file?.path())?;
            }
        }
        if self.cleaner.get().is_none() {
            let _ = self.cleaner.set(Cleaner::start(self.dir.path())?);
        }
        Ok(())
    }

    /// From now on the browser is offline.
    pub fn stop_serving(&self) {
        lock(&self.server).take();
    }

    /// Kills the browser, and starts one with what it has kept.
    pub fn kill_browser(&mut self) -> Result<()> {
        self.chromium.kill()?;
        self.chromium = start_browser(self.dir.path(), &self.origin)?;
        Ok(())
    }

    /// The directory in which the browser looks for adapters.
    pub fn udev_dir(&self) -> PathBuf {
        udev_dir(self.dir.path())
    }

    /// The directory in which the browser saves files.
    pub fn downloads(&self) -> PathBuf {
        downloads_dir(self.dir.path())
    }
}

/// Removes the directory of a browser after this program: Rust drops no static value when a program exits.
struct Cleaner(#[expect(dead_code, reason = "its standard input closes with it")] Child);

impl Cleaner {
    fn start(dir: &Path) -> Result<Self> {
        // The browser ends with the pipe to this program. Its helper processes write into the directory until then.
        let mut shell = Command::new("sh");
        shell.args(["-c", r#"cat; sleep 2; rm -rf "$0""#]).arg(dir);
        shell.stdin(Stdio::piped());
        shell.stdout(Stdio::null()).stderr(Stdio::null());
        // Ctrl-C ends the tests, not this.
        shell.process_group(0);
        let shell = shell.spawn().context("no shell that cleans up")?;
        Ok(Self(shell))
    }
}

/// Equipment for the built page that was used before and is clear again.
pub fn idle() -> MutexGuard<'static, Vec<Arc<Equipment>>> {
    lock(&IDLE)
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn start_browser(dir: &Path, origin: &str) -> Result<Chromium> {
    let (profile, downloads) = (dir.join("profile"), downloads_dir(dir));
    Chromium::start(&profile, &udev_dir(dir), &downloads, origin)
}

/// Serves the page on a free port of this machine.
fn serve(pages: &Path, delivery: Delivery) -> Result<Server> {
    fs::metadata(pages.join("index.html"))
        .with_context(|| format!("no index.html to serve in {}", pages.display()))?;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).context("no port to serve on")?;
    Ok(Server::start(listener, files(pages, delivery)?)?)
}

fn udev_dir(dir: &Path) -> PathBuf {
    dir.join("udev")
}

fn downloads_dir(dir: &Path) -> PathBuf {
    dir.join("downloads")
}
