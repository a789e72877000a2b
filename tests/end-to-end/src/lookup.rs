//! Finds controls by role and name, and waits for what they read.

use std::time::{Duration, Instant};

use anyhow::{Context, Error, Result, anyhow, bail};
use serde_json::json;

use crate::cdp::at;
use crate::control::Control;
use crate::document::Found;
use crate::page::Page;
use crate::wait::{WAIT_MAX, wait_until};

/// For this long a control that a query found is read again by its node: 2.5 ms of the browser's time, where a query takes
/// 25 ms. Only a query notices another control of the same name.
const REMEMBERED_FOR: Duration = Duration::from_millis(300);

impl Page {
    /// All controls of this role and name, in the page's order. Roles are as in HTML and ARIA;
    /// `output` is a synonym of `status`, as it is to the browser.
    ///
    /// # Errors
    ///
    /// When Chromium does not answer.
    pub fn find_all(&self, role: &str, name: &str) -> Result<Vec<Control>> {
        let named = self.query("accessibleName", name)?;
        let key = (browser_role(role).to_owned(), name.to_owned());
        let found: Vec<Control> = named
            .into_iter()
            .filter(|control| control.role == key.0)
            .collect();
        let at = Instant::now();
        let mut document = self.session.document();
        match found[..] {
            [Control { node, .. }] => document.controls.insert(key, Found { node, at }),
            _ => document.controls.remove(&key),
        };
        Ok(found)
    }

    /// The control of this role and name, as soon as it exists.
    ///
    /// # Errors
    ///
    /// When there is none: the error lists those of this role. When there is more than one: a second one is
    /// noticed within 300 ms.
    pub fn find(&self, role: &str, name: &str) -> Result<Control> {
        let found = wait_until(&format!("{role} {name:?}"), WAIT_MAX, || {
            if let Some(control) = self.find_again(role, name) {
                return Ok(Ok(control));
            }
            let mut found = self.find_all(role, name)?;
            match found.pop() {
                Some(control) if found.is_empty() => Ok(Ok(control)),
                Some(_) => bail!("{} of {role} {name:?}, not one", found.len() + 1),
                None => Ok(Err("none".to_owned())),
            }
        });
        found.map_err(|error| self.with_controls_of_role(role, &error))
    }

    /// The control that a query has just found, if it still has this role and name.
    fn find_again(&self, role: &str, name: &str) -> Option<Control> {
        let role = browser_role(role);
        let key = (role.to_owned(), name.to_owned());
        let found = self.session.document().controls.get(&key).copied()?;
        if found.at.elapsed() > REMEMBERED_FOR {
            return None;
        }
        let alone = json!({ "backendNodeId": found.node, "fetchRelatives": false });
        let node = self.session.call("Accessibility.getPartialAXTree", alone);
        Control::read(&self.session, at(&node.ok()?, "/nodes/0"))
            .filter(|control| control.role == role && control.name == name)
    }

    /// Waits until the text of a read-out fulfils a condition, and returns it.
    ///
    /// # Errors
    ///
    /// When it does not in [`WAIT_MAX`]: the error contains the last text.
    pub fn wait_for_text(
        &self,
        role: &str,
        name: &str,
        wanted: impl Fn(&str) -> bool,
    ) -> Result<String> {
        self.wait_for_text_within(WAIT_MAX, role, name, wanted)
    }

    /// The same with another timeout.
    ///
    /// # Errors
    ///
    /// As for [`Page::wait_for_text`].
    pub fn wait_for_text_within(
        &self,
        wait_max: Duration,
        role: &str,
        name: &str,
        wanted: impl Fn(&str) -> bool,
    ) -> Result<String> {
        let what = format!("{role} {name:?} to read as it should");
        let mut exists = false;
        let read = wait_until(&what, wait_max, || {
            let control = match self.find_again(role, name) {
                Some(control) => Some(control),
                None => self.find_all(role, name)?.pop(),
            };
            exists = control.is_some();
            let Some(control) = control else {
                return Ok(Err("none".to_owned()));
            };
            Ok(match control.text() {
                Ok(text) if wanted(&text) => Ok(text),
                Ok(text) => Err(format!("{text:?}")),
                // The page may replace it between finding and reading it.
                Err(error) => Err(format!("{error:#}")),
            })
        });
        match read {
            Err(error) if !exists => Err(self.with_controls_of_role(role, &error)),
            read => read,
        }
    }

    pub(crate) fn query(&self, field: &str, wanted: &str) -> Result<Vec<Control>> {
        loop {
            let loader = self.session.document().loader.clone();
            let query = json!({ "backendNodeId": self.root()?, field: wanted });
            let found = self.session.call("Accessibility.queryAXTree", query);
            if self.session.document().loader != loader {
                // Another document has come meanwhile.
                continue;
            }
            let found = found?;
            let nodes = at(&found, "/nodes").as_array().into_iter().flatten();
            return Ok(nodes
                .filter_map(|node| Control::read(&self.session, node))
                .collect());
        }
    }

    /// The node of the document itself.
    fn root(&self) -> Result<i64> {
        let (loader, known) = {
            let document = self.session.document();
            (document.loader.clone(), document.root)
        };
        if let Some(root) = known {
            return Ok(root);
        }
        let reply = self
            .session
            .call("DOM.getDocument", json!({ "depth": 0 }))?;
        let root = at(&reply, "/root/backendNodeId").as_i64();
        let mut document = self.session.document();
        if document.loader == loader {
            document.root = root;
        }
        root.context("a document without a root")
    }

    /// An error about a missing control, and the controls of this role that are there instead.
    fn with_controls_of_role(&self, role: &str, error: &Error) -> Error {
        let there_is = match self.query("role", browser_role(role)) {
            Ok(alike) if alike.is_empty() => format!("there is no {role} at all"),
            Ok(alike) => {
                let titles: Vec<String> = alike.iter().map(Control::title).collect();
                format!("there is {}", titles.join(", "))
            }
            Err(error) => format!("no {role} can be looked for: {error:#}"),
        };
        anyhow!("{error:#}; {there_is}")
    }
}

/// Chromium's name of a role.
pub(crate) fn browser_role(role: &str) -> &str {
    match role {
        "output" => "status",
        "img" => "image",
        other => other,
    }
}
