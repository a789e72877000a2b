//! Errors of a page.

use std::sync::{Arc, Mutex, PoisonError};

use anyhow::Result;
use serde_json::{Value, json};

use crate::cdp::{Session, at};

/// Errors of a tab and of its workers, in order of arrival.
#[derive(Clone, Default)]
pub struct Console(Arc<Mutex<Vec<String>>>);

impl Console {
    /// Listens to a tab from now on.
    pub fn listen(session: &Session) -> Result<Self> {
        let console = Self::default();
        let errors = Arc::clone(&console.0);
        session.listen(move |method, event| {
            if let Some(error) = error_of(method, event) {
                errors
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .push(error);
            }
        });
        for domain in ["Runtime", "Network", "Log"] {
            session.call(&format!("{domain}.enable"), json!({}))?;
        }
        Ok(console)
    }

    /// Everything so far.
    pub fn errors(&self) -> Vec<String> {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }
}

/// What an event says is wrong.
fn error_of(method: &str, event: &Value) -> Option<String> {
    match method {
        "Runtime.consoleAPICalled" => {
            let is_bad = at(event, "/type") == "error" || at(event, "/type") == "assert";
            let arguments = at(event, "/args").as_array().filter(|_| is_bad)?;
            let words = arguments.iter().map(|argument| {
                let value = argument.get("value");
                text_of(value.unwrap_or(at(argument, "/description")))
            });
            Some(format!("console: {}", words.collect::<Vec<_>>().join(" ")))
        }
        "Runtime.exceptionThrown" => {
            let details = at(event, "/exceptionDetails");
            let thrown = details.pointer("/exception/description");
            Some(format!(
                "uncaught: {}",
                text_of(thrown.unwrap_or(at(details, "/text")))
            ))
        }
        // Messages of the browser itself, and of workers, which have no console here.
        "Log.entryAdded" => {
            let entry = at(event, "/entry");
            let [source, text, url] =
                ["/source", "/text", "/url"].map(|part| text_of(at(entry, part)));
            (at(entry, "/level") == "error").then(|| format!("{source}: {text} {url}"))
        }
        "Network.loadingFailed" => {
            // A page that is closed cancels its unfinished requests.
            let is_canceled = at(event, "/canceled") == true;
            (!is_canceled).then(|| format!("request failed: {}", text_of(at(event, "/errorText"))))
        }
        "Network.responseReceived" => {
            let status = at(event, "/response/status").as_u64()?;
            let url = text_of(at(event, "/response/url"));
            (status >= 400).then(|| format!("request failed: {status} {url}"))
        }
        _ => None,
    }
}

fn text_of(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
