//! The link to the recorder, the worker that keeps the packet log and the recording.

use js_sys::{Array, Uint8Array};
use leptos::logging;
use motorlink_messages::{
    decode, encode,
    recorder::{FromRecorder, ToRecorder},
};
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{Blob, MessageChannel, MessagePort};

use crate::link::{
    started_worker::{NoWorker, Role, StartedWorker},
    worker_link::WorkerLink,
};

/// The page's end of the link to the recorder.
pub(crate) struct RecorderLink(StartedWorker);

impl RecorderLink {
    /// Starts the recorder. `on_message` gets every message with its file, if it has one; `lost` is called when
    /// the recorder has failed.
    pub(crate) fn spawn(
        mut on_message: impl FnMut(FromRecorder, Option<Blob>) + 'static,
        lost: impl FnMut() + 'static,
    ) -> Result<Self, NoWorker> {
        let started = StartedWorker::start(
            Role::Recorder,
            Box::new(move |_, data| {
                let (bytes, file) = with_file(data);
                match decode::<FromRecorder>(&Uint8Array::new(&bytes).to_vec()) {
                    Ok(message) => on_message(message, file),
                    // Both are of one build, and the texts of the causes are long.
                    Err(_) => logging::error!("a message of the recorder does not read"),
                }
            }),
            Box::new(lost),
        )?;
        Ok(Self(started))
    }

    /// Sends one message, at once.
    pub(crate) fn post(&self, message: &ToRecorder) {
        if let Ok(bytes) = encode(message) {
            self.0.post(&bytes);
        }
    }

    /// Connects the port worker to the recorder, so that no frame passes through the page.
    pub(crate) fn connect(&self, worker: &WorkerLink) {
        match MessageChannel::new() {
            Ok(channel) => {
                self.0.hand_over(&channel.port1());
                worker.hand_over(&channel.port2());
            }
            Err(error) => logging::error!("there is no line between the workers: {error:?}"),
        }
    }

    /// Posts it a port on which the session worker requests what it keeps.
    pub(crate) fn hand_over(&self, port: &MessagePort) {
        self.0.hand_over(port);
    }

    /// Terminates it, which frees its memory.
    pub(crate) fn end(&self) {
        self.0.end();
    }
}

/// A message is bytes, or an array of bytes and a file.
fn with_file(data: &JsValue) -> (JsValue, Option<Blob>) {
    match data.dyn_ref::<Array>() {
        Some(pair) => (pair.get(0), pair.get(1).dyn_into().ok()),
        None => (data.clone(), None),
    }
}
