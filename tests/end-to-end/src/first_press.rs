//! Measures how soon a page can be used.

use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::{Value, json};

use crate::bench::Bench;
use crate::page::Page;
use crate::wait::wait_until;

/// Maximal time until the page is complete, also on a slowed-down processor.
const WAIT_MAX: Duration = Duration::from_secs(60);

/// Presses a button in the first frame in which a user could, and continues until the frame painted before the page
/// is removed.
const PRESS_SOON: &str = r#"((name) => {
    const first = (globalThis.firstPress = {});
    const canBePressed = (button) => {
        const { x, y, width, height } = button.getBoundingClientRect();
        const there = document.elementFromPoint(x + width / 2, y + height / 2);
        return button.contains(there) && !button.disabled && button.ariaDisabled !== "true";
    };
    const look = () => {
        const frame = document.getElementById("starting");
        const buttons = [...document.querySelectorAll("button")];
        // Another one of this name may be hidden.
        const named = buttons.filter((it) => (it.ariaLabel ?? it.textContent.trim()) === name);
        const button = named.find(canBePressed);
        if (first.usable === undefined) {
            if (button) {
                first.usable = performance.now();
                button.click();
            }
        } else if (!frame) {
            first.whole = performance.now();
            return;
        }
        requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
})"#;

/// What a first visit is slowed down by.
#[derive(Clone, Copy)]
pub struct Slowness {
    /// Slowdown of the processor.
    pub processor: f64,
    /// Whether the network is a slow 4G, as Lighthouse simulates it: 1.6 Mbit/s with 150 ms of round trip.
    pub slow_4g: bool,
}

/// A first visit by a user who presses a button at once.
pub struct FirstPress {
    /// Time from the visit to the press, in milliseconds.
    pub usable_ms: f64,
    /// Time from the visit until the page is complete, in milliseconds.
    pub whole_ms: f64,
}

impl FirstPress {
    /// Visits the page, slowed down, and presses the button of this name.
    ///
    /// # Errors
    ///
    /// When nothing can be pressed within a minute.
    pub fn on(bench: &Bench, slowness: Slowness, button: &str) -> Result<(Page, Self)> {
        let page = bench.open_blank()?;
        page.slow_down(slowness.processor)?;
        if slowness.slow_4g {
            page.slow_4g()?;
        }
        page.before_load(&format!("{PRESS_SOON}({})", json!(button)))?;
        page.go(&bench.origin())?;
        let first = wait_until("all of the page", WAIT_MAX, || {
            let first = page.evaluate("globalThis.firstPress")?;
            let whole = first.get("whole").is_some();
            Ok(if whole {
                Ok(first)
            } else {
                Err(first.to_string())
            })
        })?;
        let ms = |name: &str| {
            let ms = first.get(name).and_then(Value::as_f64);
            ms.with_context(|| format!("{name} in {first}"))
        };
        let first = Self {
            usable_ms: ms("usable")?,
            whole_ms: ms("whole")?,
        };
        Ok((page, first))
    }
}

impl Page {
    /// Slows down the page's main thread by a factor, until the page is closed.
    fn slow_down(&self, times: f64) -> Result<()> {
        let rate = json!({ "rate": times });
        let slowed = self.session.call("Emulation.setCPUThrottlingRate", rate);
        slowed.map(drop)
    }

    /// Slows down what the page fetches, until it is closed.
    fn slow_4g(&self) -> Result<()> {
        self.session.call("Network.enable", json!({}))?;
        let bytes_a_second = |bits: f64| bits / 8.0;
        let slowed = self.session.call(
            "Network.emulateNetworkConditions",
            json!({
                "offline": false,
                "latency": 150,
                "downloadThroughput": bytes_a_second(1.6e6),
                "uploadThroughput": bytes_a_second(750e3),
            }),
        );
        slowed.map(drop)
    }
}
