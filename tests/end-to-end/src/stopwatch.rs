//! Measures when the page receives a key, on the clock of the wire.
//!
//! A page's `performance.now()` also runs on `CLOCK_MONOTONIC`, in steps of 0.1 ms. Chromium reports its zero, the
//! start of the navigation, to the microsecond. Each measurement checks that both clocks agree: it reads our clock
//! before and after asking the page for its time.

use anyhow::{Context, Result, ensure};
use serde_json::json;

use crate::cdp::{Session, at};
use crate::clock::now_us;
use crate::keyboard::Key;

/// Number of times that the page is asked for its time. One fast answer would be enough.
const ROUNDS: usize = 5;

/// The step of `performance.now()` in a page that is not cross-origin isolated, microseconds.
const STEP_US: f64 = 100.0;

/// Runs in every page before its own scripts: records every key as early as possible.
pub const NOTE_KEYS: &str = "
    globalThis.benchKeys = [];
    addEventListener('keydown', (event) => {
        benchKeys.push({ key: event.key, sent: event.timeStamp, heard: performance.now() });
    }, { capture: true });
";

/// A key press as seen by the page, on the clock of [`now_us`], to 0.1 ms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KeyPress {
    /// When the browser sent the event (`event.timeStamp`).
    pub sent_us: u64,
    /// When the page's first listener received it.
    pub received_us: u64,
}

/// Zero of the page's clock, in microseconds of our clock.
fn zero_us(session: &Session) -> Result<f64> {
    let metrics = session.call("Performance.getMetrics", json!({}))?;
    let metrics = at(&metrics, "/metrics")
        .as_array()
        .map(Vec::as_slice)
        .unwrap_or_default();
    let start = metrics
        .iter()
        .find(|metric| at(metric, "/name") == "NavigationStart");
    let seconds = start.and_then(|metric| at(metric, "/value").as_f64());
    let zero_us = seconds.context("Chromium does not say when the navigation started")? * 1e6;
    for _ in 0..ROUNDS {
        let before_us = exact(now_us());
        let page_us = session
            .evaluate("performance.now()")?
            .as_f64()
            .context("no time")?
            * 1e3;
        let after_us = exact(now_us());
        let bounds = before_us - STEP_US..=after_us + STEP_US;
        ensure!(
            bounds.contains(&(zero_us + page_us)),
            "the page's clock is not the wire's: {page_us} after {zero_us} is not in {bounds:?}"
        );
    }
    Ok(zero_us)
}

/// Presses and releases a key. Returns when the page received it.
pub fn press(session: &Session, key: &Key) -> Result<KeyPress> {
    let zero_us = zero_us(session)?;
    session.evaluate("benchKeys.length = 0")?;
    crate::control::press(session, key)?;
    let noted = session.evaluate("benchKeys[0] ?? null")?;
    let on_our_clock = |pointer| {
        let page_ms = at(&noted, pointer)
            .as_f64()
            .context("the page did not get the key")?;
        anyhow::Ok(whole(zero_us + page_ms * 1e3))
    };
    Ok(KeyPress {
        sent_us: on_our_clock("/sent")?,
        received_us: on_our_clock("/heard")?,
    })
}

/// Microseconds since boot stay below 2^53 for 285 years.
#[expect(clippy::cast_precision_loss, reason = "see above")]
fn exact(us: u64) -> f64 {
    us as f64
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "as for `exact`"
)]
fn whole(us: f64) -> u64 {
    us.round() as u64
}
