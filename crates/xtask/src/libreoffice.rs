//! LibreOffice Calc, which opens the exported CSV files in a test.

use std::path::PathBuf;

use anyhow::{Result, bail};

use crate::programs;

/// Finds it, or installs it with the system's package manager if that is allowed.
pub fn ensure() -> Result<PathBuf> {
    if let Some(program) = find()? {
        return Ok(program);
    }
    // Without windows: 90 MB.
    if programs::install(&["libreoffice-calc-nogui"])?
        && let Some(program) = find()?
    {
        return Ok(program);
    }
    bail!(
        "LibreOffice is missing: install it (Debian: apt-get install libreoffice-calc-nogui) or name \
         its program soffice in MOTORLINK_LIBREOFFICE"
    )
}

fn find() -> Result<Option<PathBuf>> {
    programs::look_up("MOTORLINK_LIBREOFFICE", &["soffice", "libreoffice"])
}
