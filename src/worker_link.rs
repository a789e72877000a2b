//! The worker: started, spoken to, listened to.

use js_sys::{Array, Uint8Array};
use leptos::logging;
use motorlink_messages::{ToPage, ToWorker, decode, encode};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use web_sys::{ErrorEvent, Event, MessageEvent, Worker, WorkerOptions, WorkerType};

use crate::clock::page_now_ms;

/// Why there is no worker to speak to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoWorker {
    /// The page does not name one.
    NotNamed,
    /// The browser does not start it.
    NotStarted,
}

/// The page's end of the line to its worker.
pub(crate) struct WorkerLink {
    worker: Worker,
    _on_message: Closure<dyn FnMut(MessageEvent)>,
    _on_error: Closure<dyn FnMut(Event)>,
}

impl WorkerLink {
    /// Starts the worker that the page names. `hear` gets every message but pings; `lost` is called
    /// when the worker has failed, after which nothing comes from it.
    pub(crate) fn spawn(
        mut hear: impl FnMut(ToPage) + 'static,
        mut lost: impl FnMut() + 'static,
    ) -> Result<Self, NoWorker> {
        let url = named_in_page().ok_or(NoWorker::NotNamed)?;
        let options = WorkerOptions::new();
        options.set_type(WorkerType::Module);
        let worker = Worker::new_with_options(&url, &options).map_err(|_| NoWorker::NotStarted)?;

        let pong = worker.clone();
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            let bytes = Uint8Array::new(&event.data()).to_vec();
            match decode::<ToPage>(&bytes) {
                // At once and before anything else: a hidden page answers too, and one whose
                // handlers no longer run must not seem alive.
                Ok(ToPage::Ping) => post(&pong, &pong_now()),
                Ok(message) => {
                    if let ToPage::Hello { .. } = message {
                        post(&pong, &pong_now());
                    }
                    hear(message);
                }
                Err(error) => logging::error!("a message of the worker does not read: {error}"),
            }
        });
        worker.set_onmessage(Some(on_message.as_ref().unchecked_ref()));

        let on_error = Closure::<dyn FnMut(Event)>::new(move |event: Event| {
            if let Some(error) = event.dyn_ref::<ErrorEvent>() {
                logging::error!("the worker failed: {}", error.message());
            }
            lost();
        });
        worker.set_onerror(Some(on_error.as_ref().unchecked_ref()));

        Ok(Self {
            worker,
            _on_message: on_message,
            _on_error: on_error,
        })
    }

    /// Sends one message, at once.
    pub(crate) fn post(&self, message: &ToWorker) {
        post(&self.worker, message);
    }
}

fn pong_now() -> ToWorker {
    ToWorker::Pong {
        page_ms: page_now_ms(),
    }
}

fn post(worker: &Worker, message: &ToWorker) {
    let Ok(bytes) = encode(message) else {
        return;
    };
    let bytes = Uint8Array::from(bytes.as_slice());
    let transfer = Array::of1(&bytes.buffer());
    let posted: Result<(), JsValue> = worker.post_message_with_transfer(&bytes, &transfer);
    if let Err(error) = posted {
        logging::error!("a message to the worker was not taken: {error:?}");
    }
}

/// The address of the worker's script, which the build writes into the page.
fn named_in_page() -> Option<String> {
    let meta = web_sys::window()?
        .document()?
        .query_selector("meta[name=motorlink-worker]")
        .ok()??;
    meta.get_attribute("content")
}
