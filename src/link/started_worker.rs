//! Starts a worker of the page, posts to it and receives from it. The links know what the messages mean.

use js_sys::{Array, Uint8Array};
use leptos::logging;
use strum::IntoStaticStr;
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use web_sys::{ErrorEvent, Event, MessageEvent, MessagePort, Worker, WorkerOptions, WorkerType};

use crate::link::files;

/// Why no worker runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoWorker {
    /// The page does not name one.
    NotNamed,
    /// The browser does not start it.
    NotStarted,
}

/// A worker. A `meta` element has the address of its script, which the build writes. The program `tasks` starts the task
/// with the name of its worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr)]
#[strum(serialize_all = "snake_case", const_into_str)]
pub(crate) enum Role {
    /// Owns the port.
    Worker,
    /// Keeps the packet log and the recording.
    Recorder,
    /// Writes and reads session files.
    Sessions,
}

impl Role {
    fn address(self) -> Option<String> {
        files::address(&format!("motorlink-{}", self.into_str()))
    }
}

/// A worker and its handlers.
pub(crate) struct StartedWorker {
    worker: Worker,
    _on_message: Closure<dyn FnMut(MessageEvent)>,
    _on_error: Closure<dyn FnMut(Event)>,
}

/// Gets the data of a message, and the worker for messages that need an answer at once.
pub(crate) type OnMessage = Box<dyn FnMut(&Worker, &JsValue)>;

impl StartedWorker {
    /// Starts the worker that the page names. `lost` is called when it has failed.
    pub(crate) fn start(
        role: Role,
        mut on_message: OnMessage,
        mut lost: Box<dyn FnMut()>,
    ) -> Result<Self, NoWorker> {
        let url = role.address().ok_or(NoWorker::NotNamed)?;
        let options = WorkerOptions::new();
        options.set_type(WorkerType::Module);
        options.set_name(role.into_str());
        let worker = Worker::new_with_options(&url, &options).map_err(|_| NoWorker::NotStarted)?;

        let receiver = worker.clone();
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            on_message(&receiver, &event.data());
        });
        worker.set_onmessage(Some(on_message.as_ref().unchecked_ref()));

        let on_error = Closure::<dyn FnMut(Event)>::new(move |event: Event| {
            if let Some(error) = event.dyn_ref::<ErrorEvent>() {
                // Otherwise the browser writes the same words to the console twice more.
                event.prevent_default();
                logging::error!("a worker failed: {}", error.message());
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

    /// Sends the bytes of a message, at once.
    pub(crate) fn post(&self, message: &[u8]) {
        post(&self.worker, message);
    }

    /// Posts it a port to another worker.
    pub(crate) fn hand_over(&self, port: &MessagePort) {
        post_with(&self.worker, port, port);
    }

    /// Sends the bytes of a message with other objects, of which these are handed over.
    pub(crate) fn post_with(&self, message: &[u8], objects: &[JsValue], handed_over: &[JsValue]) {
        let all = Array::of1(&Uint8Array::from(message));
        for object in objects.iter().chain(handed_over) {
            all.push(object);
        }
        let handed_over: Array = handed_over.iter().collect();
        if let Err(error) = self.worker.post_message_with_transfer(&all, &handed_over) {
            logging::error!("a message to a worker was not taken: {error:?}");
        }
    }

    /// Terminates the worker at once. Messages that have not arrived yet are dropped.
    pub(crate) fn end(&self) {
        self.worker.terminate();
        self.worker.set_onmessage(None);
        self.worker.set_onerror(None);
    }
}

/// Sends the bytes of a message, at once.
pub(crate) fn post(worker: &Worker, message: &[u8]) {
    let bytes = Uint8Array::from(message);
    post_with(worker, &bytes, &bytes.buffer());
}

fn post_with(worker: &Worker, message: &JsValue, transferred: &JsValue) {
    let posted = worker.post_message_with_transfer(message, &Array::of1(transferred));
    if let Err(error) = posted {
        logging::error!("a message to a worker was not taken: {error:?}");
    }
}
