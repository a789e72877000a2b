//! The places of the page, and the panels in them.

use anyhow::{Result, bail};
use motorlink_i18n::{tr, translated};

use crate::Page;

impl Page {
    /// Opens the place of a panel, which has this name in English.
    ///
    /// # Errors
    ///
    /// If no place has it.
    pub fn open_panel(&self, panel: &str) -> Result<()> {
        let role = if panel == "Control" {
            "tablist"
        } else {
            "region"
        };
        if !self.find_all(role, translated(panel))?.is_empty() {
            return Ok(());
        }
        let place = match panel {
            "Control" | "Drive together" | "Telemetry" => tr!("Drive" as "place"),
            "Recording" | "Session file" => tr!("Record" as "place"),
            "Experiments" => tr!("Test" as "place"),
            "ID Manager" | "Settings" => tr!("Setup" as "place"),
            "Link health" | "Raw Hex" => tr!("Diagnose" as "place"),
            _ => bail!("no place has the panel {panel:?}"),
        };
        self.click("button", place)?;
        match panel {
            "Drive together" => self.click("radio", tr!("Group")),
            "Control" if !self.find_all("radio", tr!("Motor"))?.is_empty() => {
                self.click("radio", tr!("Motor"))
            }
            _ => Ok(()),
        }
    }
}
