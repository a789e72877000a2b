//! Reads the content of a read-out: items of a list, pixels of a picture.

use anyhow::{Context, Result, bail};

use crate::control::Control;
use crate::lookup::browser_role;
use crate::page::Page;
use crate::wait::{WAIT_MAX, wait_until};

impl Page {
    /// The control of this role whose name contains `part`, as soon as it exists.
    ///
    /// # Errors
    ///
    /// When there is none, or more than one.
    pub fn find_like(&self, role: &str, part: &str) -> Result<Control> {
        wait_until(&format!("{role} with {part:?}"), WAIT_MAX, || {
            let of_role = self.query("role", browser_role(role))?;
            let titles: Vec<String> = of_role.iter().map(Control::title).collect();
            let mut alike = of_role.into_iter().filter(|it| it.name.contains(part));
            Ok(match (alike.next(), alike.next()) {
                (Some(only), None) => Ok(only),
                (Some(_), Some(_)) => bail!("more than one {role} with {part:?}: {titles:?}"),
                (None, _) => Err(titles.join(", ")),
            })
        })
    }
}

impl Control {
    /// The texts of the items of a list, in the page's order.
    ///
    /// # Errors
    ///
    /// When it has left the page.
    pub fn items(&self) -> Result<Vec<String>> {
        let texts = self.ask(
            "function () {
                const items = [...this.querySelectorAll('li, [role=listitem]')];
                return items.map((item) => item.textContent.trim().replace(/\\s+/g, ' '));
            }",
            &[],
        )?;
        serde_json::from_value(texts).context("a list without items")
    }

    /// Number of pixels of a canvas with a strong colour, not grey or nearly grey.
    ///
    /// # Errors
    ///
    /// When it contains no canvas.
    pub fn coloured_pixels(&self) -> Result<u64> {
        let count = self.ask(
            "function () {
                let count = 0;
                for (const canvas of this.matches('canvas') ? [this] : this.querySelectorAll('canvas')) {
                    const { width, height } = canvas;
                    if (!width || !height) continue;
                    const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
                    for (let i = 0; i < data.length; i += 4) {
                        const [red, green, blue, alpha] = data.subarray(i, i + 4);
                        const chroma = Math.max(red, green, blue) - Math.min(red, green, blue);
                        if (alpha > 128 && chroma > 96) count += 1;
                    }
                }
                return count;
            }",
            &[],
        )?;
        count.as_u64().context("no count of pixels")
    }
}
