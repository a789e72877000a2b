//! A page whose workers the bench can speak for: a wire carries 350 exchanges a second, a page must
//! bear 500.

use std::fmt::Write;

use anyhow::{Context, Result, ensure};
use end_to_end::{Bench, Control, Page, View, WAIT_MAX, wait_until};
use motorlink_messages::{ToPage, decode};
use serde_json::{Value, json};

const TAP: &str = include_str!("tap.js");

/// Who is spoken to.
#[derive(Debug, Clone, Copy)]
pub enum Taker {
    /// The page, as by the worker that owns the port.
    Page,
    /// The recorder, as by that worker.
    Recorder,
}

/// A message and when it is to be taken, in microseconds of the worker's clock.
pub struct Message {
    pub due_us: u64,
    pub bytes: Vec<u8>,
}

/// A page with a tap on its lines.
pub struct TappedPage {
    pub page: Page,
    /// By which the page takes what it is given: as arguments. The text of a script would stay in its
    /// memory, which is measured.
    hand: Control,
    /// Where the zero of the worker's clock is on the page's.
    worker_zero_ms: f64,
}

impl TappedPage {
    pub fn open(bench: &Bench, view: View) -> Result<Self> {
        // With which the page measures its drawings.
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
        let hand = page.find("button", "Help")?;
        Ok(Self {
            page,
            hand,
            worker_zero_ms: time_origin_ms - page_origin_ms,
        })
    }

    /// Keeps the worker from saying anything more.
    pub fn mute_worker(&self) -> Result<()> {
        self.page.evaluate("benchTap.muted = true").map(drop)
    }

    /// Now, in microseconds of the worker's clock.
    pub fn now_us(&self) -> Result<u64> {
        let page_ms = number(&self.page.evaluate("performance.now()")?)?;
        Ok(whole((page_ms - self.worker_zero_ms) * 1e3))
    }

    /// Gives messages, oldest first; they are taken at their times.
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
        self.hand.ask(give, &given).map(drop)
    }

    /// How many messages wait for their times.
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
        // Writing into a text does not fail.
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
