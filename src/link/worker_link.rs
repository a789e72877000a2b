//! The line to the worker that owns the port.

use std::{cell::Cell, rc::Rc};

use js_sys::Uint8Array;
use leptos::logging;
use motorlink_messages::{ToPage, ToWorker, decode, encode};
use web_sys::{MessagePort, Worker};

use crate::{
    link::started_worker::{NoWorker, Program, StartedWorker, post},
    ui::clock::page_now_ms,
};

/// Whether the worker lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WorkerState {
    /// Its code is being loaded.
    Starting,
    /// It has sent its first message.
    Running,
    /// It could not be started, or it has failed.
    Dead,
}

/// A worker with an open port pings four times a second. One that has not when it was looked for so often,
/// a second apart, is dead: a machine that is held up for so long is none to drive with.
const SILENT_LOOKS_MAX: u32 = 5;

/// The page's end of the line to its worker.
pub(crate) struct WorkerLink {
    worker: StartedWorker,
    /// How often it was looked since the last ping, if there was one. Time alone would say nothing: a page
    /// that hung has not yet been given what came meanwhile.
    silent_looks: Rc<Cell<Option<u32>>>,
}

impl WorkerLink {
    /// Starts the worker that the page names. `on_message` gets every message but pings; `lost` is called
    /// when the worker has failed, after which nothing comes from it.
    pub(crate) fn spawn(
        mut on_message: impl FnMut(ToPage) + 'static,
        lost: impl FnMut() + 'static,
    ) -> Result<Self, NoWorker> {
        let silent_looks = Rc::new(Cell::new(None));
        let looks = Rc::clone(&silent_looks);
        let worker = StartedWorker::start(
            Program::Worker,
            Box::new(move |worker, data| {
                match decode::<ToPage>(&Uint8Array::new(data).to_vec()) {
                    // At once and before anything else: a hidden page answers too, and one whose
                    // handlers no longer run must not seem alive.
                    Ok(ToPage::Ping) => {
                        looks.set(Some(0));
                        pong(worker);
                    }
                    Ok(message) => {
                        if let ToPage::Hello { .. } = message {
                            pong(worker);
                        }
                        on_message(message);
                    }
                    Err(error) => logging::error!("a message of the worker does not read: {error}"),
                }
            }),
            Box::new(lost),
        )?;
        Ok(Self {
            worker,
            silent_looks,
        })
    }

    /// Sends one message, at once.
    pub(crate) fn post(&self, message: &ToWorker) {
        if let Ok(bytes) = encode(message) {
            self.worker.post(&bytes);
        }
    }

    /// Gives it the port into which it posts all that passes on the line.
    pub(crate) fn hand_over(&self, port: &MessagePort) {
        self.worker.hand_over(port);
    }

    /// Ends it, whatever it does: no frame leaves any more, and no message of it arrives any more.
    pub(crate) fn end(&self) {
        self.worker.end();
    }

    /// Looks whether a worker that pings has died without a word, or hangs.
    pub(crate) fn has_died(&self, pings: bool) -> bool {
        let looks = self.silent_looks.get().filter(|_| pings);
        self.silent_looks.set(looks.map(|looks| looks + 1));
        looks >= Some(SILENT_LOOKS_MAX)
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
