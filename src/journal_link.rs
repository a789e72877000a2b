//! The line to the journal, the worker that keeps the packet log and the recording.

use js_sys::{Array, Uint8Array};
use leptos::logging;
use motorlink_messages::{
    decode, encode,
    journal::{FromJournal, ToJournal},
};
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{Blob, MessageChannel};

use crate::{
    started_worker::{NoWorker, StartedWorker},
    worker_link::WorkerLink,
};

/// By which the script knows that it is the journal.
const NAME: &str = "journal";

/// The page's end of the line to the journal.
pub(crate) struct JournalLink(StartedWorker);

impl JournalLink {
    /// Starts the journal. `hear` gets every message, and the file that came with it; `lost` is
    /// called when it has failed.
    pub(crate) fn spawn(
        mut hear: impl FnMut(FromJournal, Option<Blob>) + 'static,
        lost: impl FnMut() + 'static,
    ) -> Result<Self, NoWorker> {
        let started = StartedWorker::start(
            NAME,
            Box::new(move |_, data| {
                let (bytes, file) = with_file(data);
                match decode::<FromJournal>(&Uint8Array::new(&bytes).to_vec()) {
                    Ok(message) => hear(message, file),
                    Err(error) => {
                        logging::error!("a message of the journal does not read: {error}");
                    }
                }
            }),
            Box::new(lost),
        )?;
        Ok(Self(started))
    }

    /// Sends one message, at once.
    pub(crate) fn post(&self, message: &ToJournal) {
        if let Ok(bytes) = encode(message) {
            self.0.post(&bytes);
        }
    }

    /// Lays a line from the worker that owns the port to the journal, so that no frame passes
    /// through the page.
    pub(crate) fn connect(&self, worker: &WorkerLink) {
        match MessageChannel::new() {
            Ok(channel) => {
                self.0.hand_over(&channel.port1());
                worker.hand_over(&channel.port2());
            }
            Err(error) => logging::error!("there is no line between the workers: {error:?}"),
        }
    }

    /// Ends it, and frees what it held.
    pub(crate) fn end(&self) {
        self.0.end();
    }
}

/// A message is bytes, or where a file comes with it, both in an array.
fn with_file(data: &JsValue) -> (JsValue, Option<Blob>) {
    match data.dyn_ref::<Array>() {
        Some(pair) => (pair.get(0), pair.get(1).dyn_into().ok()),
        None => (data.clone(), None),
    }
}
