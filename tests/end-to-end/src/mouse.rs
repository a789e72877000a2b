//! Mouse actions on a control.

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};

use crate::cdp::at;
use crate::control::Control;

impl Control {
    /// Clicks it with the mouse, at its middle.
    ///
    /// # Errors
    ///
    /// When it is disabled, has no size, or is covered: a user could not click it either.
    pub fn click(&self) -> Result<()> {
        let (x, y) = self.reachable_middle()?;
        for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
            self.mouse(kind, x, y)?;
        }
        Ok(())
    }

    /// Holds the mouse down on it until [`Control::release`].
    ///
    /// # Errors
    ///
    /// As for [`Control::click`].
    pub fn hold(&self) -> Result<()> {
        let (x, y) = self.reachable_middle()?;
        self.mouse("mouseMoved", x, y)?;
        self.mouse("mousePressed", x, y)
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
        let (x, y) = self.reachable_middle()?;
        self.mouse("mouseMoved", x, y)?;
        self.mouse("mousePressed", x, y)?;
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

    fn reachable_middle(&self) -> Result<(f64, f64)> {
        ensure!(
            !self.disabled,
            "{} is disabled: {}",
            self.title(),
            self.description
        );
        self.session
            .call(
                "DOM.scrollIntoViewIfNeeded",
                json!({ "backendNodeId": self.node }),
            )
            .with_context(|| format!("cannot scroll to {}", self.title()))?;
        let Some(covered_by) = self.what_covers(self.middle()?)? else {
            return self.middle();
        };
        // A fixed element may cover it: a user scrolls on.
        self.ask(
            "function () { this.scrollIntoView({ block: 'center', behavior: 'instant' }); }",
            &[],
        )?;
        let middle = self.middle()?;
        match self.what_covers(middle)? {
            None => Ok(middle),
            Some(_) => bail!(
                "at the middle of {} there is {covered_by} instead",
                self.title()
            ),
        }
    }

    /// The element that a click at this point hits instead.
    fn what_covers(&self, (x, y): (f64, f64)) -> Result<Option<String>> {
        // A label over its own field forwards the click to it.
        let function = "function (x, y) {
            const hit = document.elementFromPoint(x, y);
            const mine = this === hit || this.contains(hit) || hit?.closest('label')?.control === this;
            return mine ? null : (hit ? hit.outerHTML.slice(0, 200) : 'nothing');
        }";
        let other = self.ask(function, &[json!(x), json!(y)])?;
        Ok(other.as_str().map(str::to_owned))
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
