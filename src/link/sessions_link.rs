//! The link to the session worker, which writes and reads session files.

use js_sys::{Array, Uint8Array};
use leptos::logging;
use motorlink_messages::{
    decode, encode,
    sessions::{FromSessions, ToSessions},
};
use wasm_bindgen::{JsCast, JsValue};
use web_sys::Blob;

use crate::link::started_worker::{NoWorker, Role, StartedWorker};

/// The page's end of the link.
pub(crate) struct SessionsLink(StartedWorker);

impl SessionsLink {
    /// Starts the worker. `on_message` gets every message with its file, if it has one; `lost` is called when the
    /// worker has failed.
    pub(crate) fn spawn(
        mut on_message: impl FnMut(FromSessions, Option<Blob>) + 'static,
        lost: impl FnMut() + 'static,
    ) -> Result<Self, NoWorker> {
        let started = StartedWorker::start(
            Role::Sessions,
            Box::new(move |_, data| {
                let (bytes, file) = match data.dyn_ref::<Array>() {
                    Some(pair) => (pair.get(0), pair.get(1).dyn_into().ok()),
                    None => (data.clone(), None),
                };
                match decode::<FromSessions>(&Uint8Array::new(&bytes).to_vec()) {
                    Ok(message) => on_message(message, file),
                    // Both are of one build, and the texts of the causes are long.
                    Err(_) => logging::error!("a message of the session worker does not read"),
                }
            }),
            Box::new(lost),
        )?;
        Ok(Self(started))
    }

    /// Sends a message with the objects that it needs: a file, and a channel that is handed over.
    pub(crate) fn post(&self, message: &ToSessions, file: &[JsValue], channel: &[JsValue]) {
        if let Ok(bytes) = encode(message) {
            self.0.post_with(&bytes, file, channel);
        }
    }

    /// Terminates it, which frees its memory.
    pub(crate) fn end(&self) {
        self.0.end();
    }
}
