//! A page for which the bench simulates the worker's messages: a real bus carries 350 exchanges a second, but the
//! page must handle 500.

use std::fmt::Write;

use anyhow::{Context, Result, ensure};
use end_to_end::{Bench, Control, Page, View, WAIT_MAX, wait_until};
use motorlink_messages::{ToPage, decode};
use serde_json::{Value, json};

const TAP: &str = include_str!("tap.js");

/// The receiver of messages.
#[derive(Debug, Clone, Copy)]
pub enum Taker {
    /// The page, which gets messages from the worker that owns the port.
    Page,
    /// The recorder, which gets messages from that worker.
    Recorder,
}

/// A message and its delivery time, in microseconds of the worker's clock.
pub struct Message {
    pub due_us: u64,
    pub bytes: Vec<u8>,
}

/// A page with a tap on its message ports.
pub struct TappedPage {
    pub page: Page,
    /// An element of the page: scripts that are called on it get the messages as arguments. The text of a script would
    /// stay in the memory of the page, which is measured.
    element: Control,
    /// Zero of the worker's clock, on the page's clock.
    worker_zero_ms: f64,
}

impl TappedPage {
    pub fn open(bench: &Bench, view: View) -> Result<Self> {
        // This parameter makes the page measure its drawings.
        let page = bench.open("/?measure")?;
        page.look(view)?;
        page.before_load(TAP)?;
        page.reload()?;
        let hello = wait_until("the worker's first message", WAIT_MAX, || {
            let hello = page.evaluate("benchTap.hello")?;
            Ok(hello
                .as_str()
                .map(str::to_owned)
                .ok_or_else(|| hello.to_string()))
        })?;
        let ToPage::Hello { time_origin_ms } = decode(&bytes_of(&hello)?)? else {
            anyhow::bail!("the worker says something before Hello");
        };
        let page_origin_ms = number(&page.evaluate("performance.timeOrigin")?)?;
        let element = page.find("button", "Help")?;
        Ok(Self {
            page,
            element,
            worker_zero_ms: time_origin_ms - page_origin_ms,
        })
    }

    /// Drops all further messages of the worker.
    pub fn mute_worker(&self) -> Result<()> {
        self.page.evaluate("benchTap.muted = true").map(drop)
    }

    /// Now, in microseconds of the worker's clock.
    pub fn now_us(&self) -> Result<u64> {
        let page_ms = number(&self.page.evaluate("performance.now()")?)?;
        Ok(whole((page_ms - self.worker_zero_ms) * 1e3))
    }

    /// Sends messages, oldest first; they are delivered at their times.
    pub fn give(&self, taker: Taker, messages: &[Message]) -> Result<()> {
        let messages: Vec<Value> = messages
            .iter()
            .map(|message| {
                let due_ms = exact(message.due_us) / 1e3 + self.worker_zero_ms;
                json!([due_ms, hex_of(&message.bytes)])
            })
            .collect();
        let taker = match taker {
            Taker::Page => "page",
            Taker::Recorder => "recorder",
        };
        let give = "function (taker, messages) { benchTap.give(taker, messages); }";
        let given = [Value::from(taker), Value::from(messages)];
        self.element.ask(give, &given).map(drop)
    }

    /// Number of messages that wait for their delivery times.
    pub fn waiting(&self) -> Result<u64> {
        let waiting = self.page.evaluate("benchTap.waiting")?;
        waiting.as_u64().context("the page does not count")
    }
}

fn number(value: &Value) -> Result<f64> {
    value.as_f64().context("the page has no time")
}

fn hex_of(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    text
}

fn bytes_of(hex: &str) -> Result<Vec<u8>> {
    ensure!(
        hex.len().is_multiple_of(2) && hex.is_ascii(),
        "no hex: {hex}"
    );
    let places = (0..hex.len()).step_by(2);
    places
        .map(|place| {
            let digits = hex.get(place..place + 2).unwrap_or_default();
            u8::from_str_radix(digits, 16).with_context(|| format!("no hex: {hex}"))
        })
        .collect()
}

/// Microseconds of minutes fit a double.
#[allow(clippy::cast_precision_loss, reason = "see above")]
fn exact(us: u64) -> f64 {
    us as f64
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "as for `exact`"
)]
fn whole(us: f64) -> u64 {
    us.round() as u64
}
