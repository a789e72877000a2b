//! A page in a tab, with the actions of a user.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::Result;
use serde_json::{Value, json};

use crate::cdp::Session;
use crate::console::Console;
use crate::control;
use crate::keyboard::Key;
use crate::stopwatch::{self, KeyPress};
use crate::wait::{WAIT_MAX, wait_until};

/// Runs in every page before its own scripts. The browser only reports tasks of more than 50 ms; the page can measure
/// parts of its own work.
pub(crate) const NOTE_WORK: &str = "
    globalThis.benchWork = { tasks: [], measures: [] };
    const benchObserver = (type, note) => {
        const observer = new PerformanceObserver((list) => list.getEntries().forEach(note));
        observer.observe({ type, buffered: true });
        return observer;
    };
    benchWork.observers = [
        [benchObserver('longtask', (entry) => benchWork.tasks.push(entry.duration)),
            (entry) => benchWork.tasks.push(entry.duration)],
        [benchObserver('measure', (entry) => benchWork.measures.push([entry.name, entry.duration])),
            (entry) => benchWork.measures.push([entry.name, entry.duration])],
    ];
    benchWork.take = () => {
        for (const [observer, note] of benchWork.observers) observer.takeRecords().forEach(note);
        const { tasks, measures } = benchWork;
        benchWork.tasks = [];
        benchWork.measures = [];
        return { tasks, measures };
    };
";

/// Runs before the scripts of a page, and notes the linear memories of its programs.
const NOTE_MEMORIES: &str = "{
    const memories = [];
    const noted = (result) => {
        const { memory } = (result.instance ?? result).exports;
        if (memory && !memories.includes(memory)) memories.push(memory);
        return result;
    };
    for (const name of ['instantiate', 'instantiateStreaming']) {
        const real = WebAssembly[name];
        WebAssembly[name] = (...given) => real.apply(WebAssembly, given).then(noted);
    }
    globalThis.wasmBytes = () => memories.reduce((sum, memory) => sum + memory.buffer.byteLength, 0);
}";

/// A page in a tab.
pub struct Page {
    pub(crate) session: Session,
    console: Console,
    /// Directory of its downloads.
    pub(crate) downloads: PathBuf,
}

impl Page {
    /// Loads `url` into a tab with this download directory.
    pub(crate) fn load(session: Session, url: &str, downloads: PathBuf) -> Result<Self> {
        Self::load_within(WAIT_MAX, session, url, downloads)
    }

    /// The same with another timeout.
    pub(crate) fn load_within(
        wait_max: Duration,
        session: Session,
        url: &str,
        downloads: PathBuf,
    ) -> Result<Self> {
        let console = Console::listen(&session)?;
        let page = Self {
            session,
            console,
            downloads,
        };
        page.before_load(stopwatch::NOTE_KEYS)?;
        page.before_load(NOTE_WORK)?;
        page.before_load(NOTE_MEMORIES)?;
        page.go_within(wait_max, url)?;
        Ok(page)
    }

    /// Runs a script before the scripts of every page that is loaded into this tab from now on.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn before_load(&self, script: &str) -> Result<()> {
        let source = json!({ "source": script });
        self.session
            .call("Page.addScriptToEvaluateOnNewDocument", source)
            .map(drop)
    }

    /// Navigates to `url`, in the same tab.
    ///
    /// # Errors
    ///
    /// When it does not load.
    pub fn go(&self, url: &str) -> Result<()> {
        self.go_within(WAIT_MAX, url)
    }

    fn go_within(&self, wait_max: Duration, url: &str) -> Result<()> {
        self.session.load(wait_max, url)?;
        self.wait_until_whole()
    }

    /// Waits until the page is complete. The header can be used earlier, but a scenario begins after that.
    fn wait_until_whole(&self) -> Result<()> {
        wait_until("all of the page", WAIT_MAX, || {
            // While it loads, evaluation fails.
            let whole = self.evaluate("document.getElementById('starting') === null");
            Ok(match whole {
                Ok(Value::Bool(true)) => Ok(()),
                other => Err(format!("{other:?}")),
            })
        })
    }

    /// Loads the page again.
    ///
    /// # Errors
    ///
    /// When it does not load.
    pub fn reload(&self) -> Result<()> {
        self.session.reload()?;
        self.wait_until_whole()
    }

    /// Clicks the control with the mouse, as soon as it exists and is enabled.
    ///
    /// # Errors
    ///
    /// When it is missing, stays disabled, or is covered.
    pub fn click(&self, role: &str, name: &str) -> Result<()> {
        let control = wait_until(&format!("{role} {name:?} to be enabled"), WAIT_MAX, || {
            let control = self.find(role, name)?;
            Ok(if control.disabled {
                Err(control.description)
            } else {
                Ok(control)
            })
        })?;
        control.click()
    }

    /// Types a value into a field or spinbutton and confirms it with Enter.
    ///
    /// # Errors
    ///
    /// When it is missing or disabled.
    pub fn fill(&self, role: &str, name: &str, text: &str) -> Result<()> {
        self.find(role, name)?.fill(text)
    }

    /// Moves a slider to a value.
    ///
    /// # Errors
    ///
    /// When it is missing or disabled.
    pub fn slide(&self, name: &str, value: f64) -> Result<()> {
        self.find("slider", name)?.slide(value)
    }

    /// Chooses an option of a combobox by its text.
    ///
    /// # Errors
    ///
    /// When it is missing, disabled, or has no such option.
    pub fn choose(&self, name: &str, option: &str) -> Result<()> {
        self.find("combobox", name)?.choose(option)
    }

    /// Presses and releases a key, named as in `KeyboardEvent.key`, wherever the focus is.
    ///
    /// # Errors
    ///
    /// When there is no such key.
    pub fn press(&self, key: &str) -> Result<()> {
        control::press(&self.session, &Key::named(key)?)
    }

    /// Presses a key and holds it until [`Page::release_key`].
    ///
    /// # Errors
    ///
    /// When there is no such key.
    pub fn hold_key(&self, key: &str) -> Result<()> {
        let down = Key::named(key)?.down();
        self.session.call("Input.dispatchKeyEvent", down).map(drop)
    }

    /// Releases a key.
    ///
    /// # Errors
    ///
    /// When there is no such key.
    pub fn release_key(&self, key: &str) -> Result<()> {
        let up = Key::named(key)?.up();
        self.session.call("Input.dispatchKeyEvent", up).map(drop)
    }

    /// Presses a key. Returns when the page received it, on the clock of the wire.
    ///
    /// # Errors
    ///
    /// When there is no such key, or the page did not get it.
    pub fn press_timed(&self, key: &str) -> Result<KeyPress> {
        stopwatch::press(&self.session, &Key::named(key)?)
    }

    /// The text of a read-out.
    ///
    /// # Errors
    ///
    /// When it is missing.
    pub fn text(&self, role: &str, name: &str) -> Result<String> {
        self.find(role, name)?.text()
    }

    /// Errors so far of the page and of its workers: console errors, uncaught exceptions, failed requests, and
    /// messages of the browser.
    #[must_use]
    pub fn console_errors(&self) -> Vec<String> {
        self.console.errors()
    }

    /// The value of a JavaScript expression in the page; a promise is awaited.
    ///
    /// # Errors
    ///
    /// When it throws, or its value cannot be JSON.
    pub fn evaluate(&self, expression: &str) -> Result<Value> {
        self.session.evaluate(expression)
    }
}
