//! Mouse actions on a control.

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};

use crate::cdp::at;
use crate::control::Control;
use crate::retry::retry;

/// Attempts to press a control under which the page moves.
const PRESSES_MAX: u32 = 3;

/// Scrolls to `this`, waits until it rests, and gives its middle, or what is wrong. Notes in `benchHit` whether the next
/// press hits it.
const REACH: &str = "async function () {
    const place = () => {
        const { x, y, width, height } = this.getBoundingClientRect();
        return { x: x + width / 2, y: y + height / 2, width, height };
    };
    const rest = async () => {
        // A hidden page has no frames.
        for (let before = place(), frame = 0; !document.hidden && frame < 50; frame++) {
            await new Promise(requestAnimationFrame);
            const now = place();
            if (JSON.stringify(now) === JSON.stringify(before)) break;
            before = now;
        }
        return place();
    };
    // A label over its own field forwards the click to it.
    const isMine = (hit) => this === hit || this.contains(hit) || hit?.closest('label')?.control === this;
    const cover = ({ x, y }) => {
        const hit = document.elementFromPoint(x, y);
        return isMine(hit) ? null : 'at its middle there is ' + (hit ? hit.outerHTML.slice(0, 200) : 'nothing');
    };
    this.scrollIntoViewIfNeeded();
    let at = await rest();
    if (!at.width || !at.height) return 'it has no size';
    if (cover(at) !== null) {
        // A fixed element may cover it: a user scrolls on.
        this.scrollIntoView({ block: 'center', behavior: 'instant' });
        at = await rest();
    }
    delete this.benchHit;
    addEventListener('pointerdown', (press) => { this.benchHit = isMine(press.target); }, { capture: true, once: true });
    return cover(at) ?? [at.x, at.y];
}";

impl Control {
    /// Clicks it with the mouse, at its middle.
    ///
    /// # Errors
    ///
    /// When it is disabled, has no size, or is covered: a user could not click it either.
    pub fn click(&self) -> Result<()> {
        let (x, y) = self.press()?;
        self.mouse("mouseReleased", x, y)
    }

    /// Holds the mouse down on it until [`Control::release`].
    ///
    /// # Errors
    ///
    /// As for [`Control::click`].
    pub fn hold(&self) -> Result<()> {
        self.press().map(drop)
    }

    /// Releases the mouse.
    ///
    /// # Errors
    ///
    /// When it has left the page.
    pub fn release(&self) -> Result<()> {
        let (x, y) = self.middle()?;
        self.mouse("mouseReleased", x, y)
    }

    /// Drags it down by these CSS pixels, or up by a negative number.
    ///
    /// # Errors
    ///
    /// As for [`Control::click`].
    pub fn drag_down(&self, pixels: f64) -> Result<()> {
        let (x, y) = self.press()?;
        // Held, the button is that of the press.
        for part in [0.5, 1.0] {
            let event = json!({
                "type": "mouseMoved", "x": x, "y": y + pixels * part, "button": "left", "buttons": 1,
            });
            self.session.call("Input.dispatchMouseEvent", event)?;
        }
        self.mouse("mouseReleased", x, y + pixels)
    }

    /// Turns the mouse wheel over it: down is positive, in CSS pixels.
    ///
    /// # Errors
    ///
    /// When it has no size, or is covered.
    pub fn turn_wheel(&self, pixels: f64) -> Result<()> {
        let (x, y) = self.reachable_middle()?;
        let event = json!({ "type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": pixels });
        self.session
            .call("Input.dispatchMouseEvent", event)
            .map(drop)
    }

    /// Presses the mouse button at its middle. While a page loads, it may move under the mouse: then the press is
    /// repeated.
    fn press(&self) -> Result<(f64, f64)> {
        retry(&format!("press {}", self.title()), PRESSES_MAX, || {
            let (x, y) = self.reachable_middle()?;
            self.mouse("mouseMoved", x, y)?;
            self.mouse("mousePressed", x, y)?;
            // What is pressed may have left the page.
            let missed = self.ask("function () { return this.benchHit === false; }", &[]);
            if missed.is_ok_and(|missed| missed == true) {
                // In a corner, so that it clicks nothing.
                self.mouse("mouseReleased", 0.0, 0.0)?;
                return Ok(Err("the page moved under the mouse".to_owned()));
            }
            Ok(Ok((x, y)))
        })
    }

    fn reachable_middle(&self) -> Result<(f64, f64)> {
        ensure!(
            !self.disabled,
            "{} is disabled: {}",
            self.title(),
            self.description
        );
        let place = self.ask(REACH, &[])?;
        match (at(&place, "/0").as_f64(), at(&place, "/1").as_f64()) {
            (Some(x), Some(y)) => Ok((x, y)),
            _ => bail!(
                "{} cannot be reached: {}",
                self.title(),
                place.as_str().unwrap_or_default()
            ),
        }
    }

    /// The middle of its box in the window, in CSS pixels.
    fn middle(&self) -> Result<(f64, f64)> {
        let function = "function () {
            const box = this.getBoundingClientRect();
            return box.width && box.height
                ? [box.x + box.width / 2, box.y + box.height / 2] : null;
        }";
        let middle = self.ask(function, &[])?;
        let [x, y] = [at(&middle, "/0"), at(&middle, "/1")].map(Value::as_f64);
        x.zip(y)
            .with_context(|| format!("{} has no size", self.title()))
    }

    fn mouse(&self, kind: &str, x: f64, y: f64) -> Result<()> {
        let (button, count) = if kind == "mouseMoved" {
            ("none", 0)
        } else {
            ("left", 1)
        };
        let event = json!({
            "type": kind, "x": x, "y": y, "button": button, "clickCount": count,
        });
        self.session
            .call("Input.dispatchMouseEvent", event)
            .map(drop)
    }
}
