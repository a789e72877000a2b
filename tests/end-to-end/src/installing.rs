//! The page as the browser's installer sees it, and its cached files.

use anyhow::Result;
use serde_json::{Value, json};

use crate::cdp::at;
use crate::page::Page;
use crate::wait::{WAIT_MAX, wait_until};

impl Page {
    /// The address of the page's manifest as found by the browser, and the manifest's errors.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn manifest(&self) -> Result<(String, Vec<Value>)> {
        let manifest = self.session.call("Page.getAppManifest", json!({}))?;
        let url = at(&manifest, "/url").as_str().unwrap_or_default();
        Ok((url.to_owned(), list(&manifest, "/errors")))
    }

    /// Why the browser would not install the page.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn installability_errors(&self) -> Result<Vec<Value>> {
        let errors = self
            .session
            .call("Page.getInstallabilityErrors", json!({}))?;
        Ok(list(&errors, "/installabilityErrors"))
    }

    /// Waits until the browser has cached the whole page.
    ///
    /// # Errors
    ///
    /// When it does not.
    pub fn wait_until_kept(&self) -> Result<()> {
        wait_until("the page to be kept", WAIT_MAX, || {
            let state = self.evaluate(
                "navigator.serviceWorker.getRegistration().then((it) => it?.active?.state ?? [it?.installing?.state, it?.waiting?.state, typeof it].join('/'))",
            )?;
            Ok(if state == "activated" {
                Ok(())
            } else {
                Err(state.to_string())
            })
        })
    }
}

fn list(reply: &Value, pointer: &str) -> Vec<Value> {
    at(reply, pointer).as_array().cloned().unwrap_or_default()
}
