//! The line to the worker that owns the port.

use js_sys::Uint8Array;
use leptos::logging;
use motorlink_messages::{ToPage, ToWorker, decode, encode};
use web_sys::{MessagePort, Worker};

use crate::{
    clock::page_now_ms,
    started_worker::{NoWorker, StartedWorker, post},
};

/// The page's end of the line to its worker.
pub(crate) struct WorkerLink(StartedWorker);

impl WorkerLink {
    /// Starts the worker that the page names. `hear` gets every message but pings; `lost` is called
    /// when the worker has failed, after which nothing comes from it.
    pub(crate) fn spawn(
        mut hear: impl FnMut(ToPage) + 'static,
        lost: impl FnMut() + 'static,
    ) -> Result<Self, NoWorker> {
        let started = StartedWorker::start(
            "",
            Box::new(move |worker, data| {
                match decode::<ToPage>(&Uint8Array::new(data).to_vec()) {
                    // At once and before anything else: a hidden page answers too, and one whose
                    // handlers no longer run must not seem alive.
                    Ok(ToPage::Ping) => pong(worker),
                    Ok(message) => {
                        if let ToPage::Hello { .. } = message {
                            pong(worker);
                        }
                        hear(message);
                    }
                    Err(error) => logging::error!("a message of the worker does not read: {error}"),
                }
            }),
            Box::new(lost),
        )?;
        Ok(Self(started))
    }

    /// Sends one message, at once.
    pub(crate) fn post(&self, message: &ToWorker) {
        if let Ok(bytes) = encode(message) {
            self.0.post(&bytes);
        }
    }

    /// Gives it the port into which it posts all that passes on the line.
    pub(crate) fn hand_over(&self, port: &MessagePort) {
        self.0.hand_over(port);
    }
}

fn pong(worker: &Worker) {
    let pong = ToWorker::Pong {
        page_ms: page_now_ms(),
    };
    if let Ok(bytes) = encode(&pong) {
        post(worker, &bytes);
    }
}
