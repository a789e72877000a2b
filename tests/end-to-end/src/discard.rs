//! Discarding: a browser that wants memory throws a hidden page away, and no event happens.

use anyhow::Result;

use crate::bench::Bench;
use crate::page::Page;
use crate::wait::{PATIENCE, wait_until};

/// Presses "Urgent Discard" in the row of the tab with this address; says whether there is one.
const DISCARD: &str = "(address) => {
    const inside = (root) => [...root.querySelectorAll('*')].flatMap((element) =>
        element.shadowRoot ? [element, ...inside(element.shadowRoot)] : [element]);
    const row = inside(document).find((element) =>
        element.tagName === 'TR' && element.querySelector('.tab-url-cell')?.textContent.includes(address));
    const buttons = row ? [...row.querySelectorAll('.actions-cell *')] : [];
    const urgent = buttons.find((element) => element.textContent.trim() === 'Urgent Discard');
    urgent?.click();
    return urgent ? 'pressed' : buttons.map((element) => element.textContent.trim()).join(', ');
}";

impl Bench {
    /// Has the browser discard a page, by its own page for that. The page is hidden then, and gone.
    ///
    /// # Errors
    ///
    /// When the browser does not show it, or does not discard it.
    pub fn discard(&self, page: &Page) -> Result<()> {
        let address = page.evaluate("location.host")?;
        let discards = Page::load(self.new_tab()?, "chrome://discards/", self.downloads())?;
        wait_until("the page to be discarded", PATIENCE, || {
            let said = discards.evaluate(&format!("({DISCARD})({address})"))?;
            Ok(if said == "pressed" {
                Ok(())
            } else {
                Err(said.to_string())
            })
        })
    }
}
