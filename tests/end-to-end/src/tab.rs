//! What happens to a page as a tab: it is hidden, shown, frozen, closed, or crashes.

use std::time::Duration;

use anyhow::{Context, Result};
use chromiumoxide::cdp::browser_protocol::target::TargetId;
use serde_json::json;

use crate::cdp::at;
use crate::page::Page;
use crate::wait::{WAIT_MAX, wait_until};

/// A crash takes milliseconds.
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

    /// Dismisses the browser's picker as a person does who turns back to the page. Without a
    /// display nobody can choose in it, as it takes neither keys nor clicks of the protocol.
    ///
    /// `dismissed` says whether the page has been told; until then it is done again, as the picker
    /// takes a moment to show.
    ///
    /// # Errors
    ///
    /// When the page is not told.
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

    /// Goes back to the page before this one, as a person does.
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

    /// Freezes the page, as a browser does with one long hidden: `freeze` happens, then nothing.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn freeze(&self) -> Result<()> {
        self.session
            .call("Page.setWebLifecycleState", json!({ "state": "frozen" }))
            .map(drop)
    }

    /// Ends the page's process at once, its workers too: no event happens, as when a browser
    /// crashes or discards a page.
    pub fn crash(self) {
        // The page does not live to answer.
        let _ = self
            .session
            .call_within(AFTER_A_CRASH, "Page.crash", json!({}));
    }

    /// Closes the tab as a person does; [`crate::Bench::close`] waits until it is gone.
    pub(crate) fn close(&self) -> Result<()> {
        self.session.call("Page.close", json!({})).map(drop)
    }

    /// What tells its tab from others.
    pub(crate) fn tab_id(&self) -> &TargetId {
        self.session.tab().target_id()
    }
}
