//! Errors of a page.

use std::sync::{Arc, Mutex, PoisonError};

use anyhow::Result;
use chromiumoxide::cdp::browser_protocol::log::{EventEntryAdded, LogEntryLevel};
use chromiumoxide::cdp::browser_protocol::network::{EventLoadingFailed, EventResponseReceived};
use chromiumoxide::cdp::js_protocol::runtime::{
    ConsoleApiCalledType, EventConsoleApiCalled, EventExceptionThrown,
};
use futures::StreamExt;
use serde_json::{Value, json};

use crate::cdp::Session;

/// Errors of a tab and of its workers, in order of arrival.
#[derive(Clone, Default)]
pub struct Console(Arc<Mutex<Vec<String>>>);

impl Console {
    /// Listens to a tab from now on.
    pub fn listen(session: &Session) -> Result<Self> {
        let console = Self::default();
        console.collect(session, |event: &EventConsoleApiCalled| {
            let bad = [ConsoleApiCalledType::Error, ConsoleApiCalledType::Assert];
            bad.contains(&event.r#type).then(|| {
                let words = event.args.iter().map(|argument| {
                    let value = argument.value.as_ref().map(text_of);
                    value
                        .or_else(|| argument.description.clone())
                        .unwrap_or_default()
                });
                format!("console: {}", words.collect::<Vec<_>>().join(" "))
            })
        })?;
        console.collect(session, |event: &EventExceptionThrown| {
            let details = &event.exception_details;
            let thrown = details
                .exception
                .as_ref()
                .and_then(|thrown| thrown.description.as_ref());
            Some(format!("uncaught: {}", thrown.unwrap_or(&details.text)))
        })?;
        // Messages of the browser itself, and of workers, which have no console here.
        console.collect(session, |event: &EventEntryAdded| {
            let entry = &event.entry;
            let url = entry.url.as_deref().unwrap_or_default();
            (entry.level == LogEntryLevel::Error)
                .then(|| format!("{}: {} {url}", entry.source.as_ref(), entry.text))
        })?;
        console.collect(session, |event: &EventLoadingFailed| {
            // A page that is closed cancels its unfinished requests.
            let canceled = event.canceled == Some(true);
            (!canceled).then(|| format!("request failed: {}", event.error_text))
        })?;
        console.collect(session, |event: &EventResponseReceived| {
            let response = &event.response;
            (response.status >= 400)
                .then(|| format!("request failed: {} {}", response.status, response.url))
        })?;
        session.call("Runtime.enable", json!({}))?;
        session.call("Network.enable", json!({}))?;
        session.call("Log.enable", json!({}))?;
        Ok(console)
    }

    /// Everything so far.
    pub fn errors(&self) -> Vec<String> {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    fn collect<E>(
        &self,
        session: &Session,
        error: impl Fn(&E) -> Option<String> + Send + 'static,
    ) -> Result<()>
    where
        E: chromiumoxide::cdp::IntoEventKind + Send + Sync + Unpin + 'static,
    {
        let listening = session.tab().event_listener::<E>();
        let mut events = session.blocking().wait("its events", listening)?;
        let errors = Arc::clone(&self.0);
        session.blocking().spawn(async move {
            while let Some(event) = events.next().await {
                if let Some(text) = error(&event) {
                    errors
                        .lock()
                        .unwrap_or_else(PoisonError::into_inner)
                        .push(text);
                }
            }
        });
        Ok(())
    }
}

fn text_of(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}
