//! Downloads and uploads of files.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result};
use serde_json::json;

use crate::cdp::at;
use crate::page::Page;
use crate::wait::{WAIT_MAX, wait_until};

/// Chromium's extension of an incomplete file.
const INCOMPLETE: &str = "crdownload";

/// A complete file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Download {
    /// The name that the page gave it.
    pub name: String,
    /// Its path, valid as long as the bench.
    pub path: PathBuf,
}

impl Download {
    /// Its extension, without the dot.
    #[must_use]
    pub fn extension(&self) -> &str {
        let extension = Path::new(&self.name).extension();
        extension.and_then(|it| it.to_str()).unwrap_or_default()
    }

    /// Its content.
    ///
    /// # Errors
    ///
    /// When it cannot be read.
    pub fn bytes(&self) -> Result<Vec<u8>> {
        fs::read(&self.path).with_context(|| format!("cannot read {}", self.path.display()))
    }
}

impl Page {
    /// Clicks a button that makes a file, and waits until the file is complete.
    ///
    /// # Errors
    ///
    /// When the button cannot be clicked, or no file comes.
    pub fn download(&self, button: &str) -> Result<Download> {
        self.download_within(WAIT_MAX, button)
    }

    /// The same with another timeout.
    ///
    /// # Errors
    ///
    /// As for [`Page::download`].
    pub fn download_within(&self, wait_max: Duration, button: &str) -> Result<Download> {
        self.click("button", button)?;
        self.next_download(wait_max, button)
    }

    /// Waits for a file that is already being downloaded; `what` names it in messages.
    ///
    /// # Errors
    ///
    /// When it does not come.
    pub fn next_download(&self, wait_max: Duration, what: &str) -> Result<Download> {
        let complete = wait_until(&format!("the file of {what:?}"), wait_max, || {
            let files = files_in(&self.downloads)?;
            let complete = files.iter().find(|path| is_complete(path));
            Ok(complete.cloned().ok_or_else(|| format!("{files:?}")))
        })?;
        self.put_away(&complete)
    }

    /// Clicks a button that asks for a file, and selects this one.
    ///
    /// The file chooser of the browser is outside of the page and is not opened: the file goes to the page's only
    /// file field.
    ///
    /// # Errors
    ///
    /// When the button cannot be clicked, or the page does not ask for a file.
    pub fn upload(&self, button: &str, file: &Path) -> Result<()> {
        let intercept = |enabled| {
            let params = json!({ "enabled": enabled });
            self.session
                .call("Page.setInterceptFileChooserDialog", params)
        };
        intercept(true)?;
        self.click("button", button)?;
        // The panels of other places have fields too.
        let expression = "[...document.querySelectorAll('input[type=file]')]
            .find((field) => field.closest('section').checkVisibility())";
        let params = json!({ "expression": expression });
        let field = self.session.call("Runtime.evaluate", params)?;
        let files = json!({ "objectId": at(&field, "/result/objectId"), "files": [file] });
        self.session.call("DOM.setFileInputFiles", files)?;
        intercept(false).map(drop)
    }

    /// Moves a file away, because the next one may have the same name.
    fn put_away(&self, file: &Path) -> Result<Download> {
        let name = file.file_name().context("a file without a name")?;
        let place = tempfile::Builder::new()
            .prefix("kept-")
            .tempdir_in(
                self.downloads
                    .parent()
                    .context("a directory without one above")?,
            )?
            .keep();
        let path = place.join(name);
        fs::rename(file, &path)?;
        Ok(Download {
            name: name.to_string_lossy().into_owned(),
            path,
        })
    }
}

fn files_in(dir: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(dir).with_context(|| format!("no {}", dir.display()))?;
    entries.map(|entry| Ok(entry?.path())).collect()
}

/// Whether a file is complete. Chromium writes to another name, which some versions hide, and renames it at the end.
/// Until then an empty file reserves the name; no exported file is empty.
fn is_complete(path: &Path) -> bool {
    if fs::metadata(path).is_ok_and(|file| file.len() == 0) {
        return false;
    }
    let hidden = path
        .file_name()
        .is_none_or(|name| name.to_string_lossy().starts_with('.'));
    !hidden
        && path
            .extension()
            .is_none_or(|extension| extension != INCOMPLETE)
}
