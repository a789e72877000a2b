//! Discarding: a browser that needs memory discards a hidden page, without an event.

use anyhow::Result;

use crate::bench::Bench;
use crate::page::Page;
use crate::wait::{WAIT_MAX, wait_until};

/// Presses `[Urgent Discard]` in the row of the tab with this address, unless it is discarded. Returns that it is
/// discarded, or the text of the row.
const DISCARD: &str = "(address) => {
    const inside = (root) => [...root.querySelectorAll('*')].flatMap((element) =>
        element.shadowRoot ? [element, ...inside(element.shadowRoot)] : [element]);
    const row = inside(document).find((element) =>
        element.tagName === 'TR' && element.querySelector('.tab-url-cell')?.textContent.includes(address));
    const buttons = row ? [...row.querySelectorAll('.actions-cell *')] : [];
    const urgent = buttons.findLast((element) => element.textContent.trim() === '[Urgent Discard]');
    if (row?.textContent.includes('discarded')) return 'discarded';
    urgent?.click();
    return row ? row.textContent.replace(/\\s+/g, ' ') : 'no such tab';
}";

impl Bench {
    /// Makes the browser discard a page through its internal page for that. It detaches the debugger first, because a
    /// page with a debugger is not discarded.
    ///
    /// # Errors
    ///
    /// When the browser does not show it, or does not discard it.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a discarded page must not be used again"
    )]
    pub fn discard(&self, page: Page) -> Result<()> {
        let address = page.evaluate("location.host")?;
        self.detach(&page)?;
        let discards = Page::load(self.new_tab()?, "chrome://discards/", self.downloads())?;
        wait_until("the page to be discarded", WAIT_MAX, || {
            let said = discards.evaluate(&format!("({DISCARD})({address})"))?;
            Ok(if said == "discarded" {
                Ok(())
            } else {
                Err(said.to_string())
            })
        })
    }
}
