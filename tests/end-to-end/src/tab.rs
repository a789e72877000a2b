//! Events of a page's tab: it is hidden, shown, frozen, closed, or crashes.

use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::json;

use crate::cdp::at;
use crate::page::Page;
use crate::wait::{WAIT_MAX, wait_until};

/// Time for a crash, which takes milliseconds.
const AFTER_A_CRASH: Duration = Duration::from_millis(500);

impl Page {
    /// `visible` or `hidden`.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn visibility(&self) -> Result<String> {
        let state = self.evaluate("document.visibilityState")?;
        state
            .as_str()
            .map(str::to_owned)
            .context("the page has no visibility")
    }

    /// Brings its tab to the front.
    ///
    /// # Errors
    ///
    /// When it does not become visible.
    pub fn show(&self) -> Result<()> {
        self.session.call("Page.bringToFront", json!({}))?;
        self.wait_for_visibility("visible")
    }

    /// Dismisses the browser's picker like a user who returns to the page. Without a display nothing can be chosen in
    /// it, because it accepts no keys or clicks of the protocol.
    ///
    /// `dismissed` returns whether the page was notified. Until then the call is repeated, because the picker takes a
    /// moment to appear.
    ///
    /// # Errors
    ///
    /// When the page is not notified.
    pub fn dismiss_picker(&self, dismissed: impl Fn() -> Result<bool>) -> Result<()> {
        wait_until("the picker to be dismissed", WAIT_MAX, || {
            self.show()?;
            Ok(if dismissed()? {
                Ok(())
            } else {
                Err("the page waits on".to_owned())
            })
        })
    }

    /// Waits until the page is `visible` or `hidden`.
    pub(crate) fn wait_for_visibility(&self, wanted: &str) -> Result<()> {
        wait_until(&format!("the page to be {wanted}"), WAIT_MAX, || {
            let state = self.visibility()?;
            Ok(if state == wanted { Ok(()) } else { Err(state) })
        })
    }

    /// Navigates back to the previous page.
    ///
    /// # Errors
    ///
    /// When there is none.
    pub fn back(&self) -> Result<()> {
        let history = self.session.call("Page.getNavigationHistory", json!({}))?;
        let here = at(&history, "/currentIndex").as_u64().unwrap_or_default();
        let before = here.checked_sub(1).context("no page before this one")?;
        let entry = at(&history, &format!("/entries/{before}/id"));
        self.session
            .call("Page.navigateToHistoryEntry", json!({ "entryId": entry }))
            .map(drop)
    }

    /// Freezes the page, as a browser does with a page hidden for long: a `freeze` event, then nothing runs.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn freeze(&self) -> Result<()> {
        self.session
            .call("Page.setWebLifecycleState", json!({ "state": "frozen" }))
            .map(drop)
    }

    /// Kills the page's process with its workers: there is no event, as when a browser crashes or discards a page.
    pub fn crash(self) {
        // The page cannot answer any more.
        let _ = self
            .session
            .call_within(AFTER_A_CRASH, "Page.crash", json!({}));
    }

    /// Closes the tab as a user does; [`crate::Bench::close`] waits until it is closed.
    pub(crate) fn close(&self) -> Result<()> {
        self.session.call("Page.close", json!({})).map(drop)
    }

    /// The ID of its tab.
    pub(crate) fn tab_id(&self) -> &str {
        self.session.target()
    }
}
