//! The link to the port worker.

use std::{cell::Cell, rc::Rc};

use js_sys::Uint8Array;
use leptos::logging;
use motorlink_messages::{ToPage, ToWorker, decode, encode};
use web_sys::{MessagePort, Worker};

use crate::{
    link::started_worker::{NoWorker, Program, StartedWorker, post},
    ui::clock::page_now_ms,
};

/// The state of the worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WorkerState {
    /// Its code is being loaded.
    Starting,
    /// It has sent its first message.
    Running,
    /// It could not be started, or it has failed.
    Dead,
}

/// A worker with an open port pings four times a second. After this number of checks without a ping, a second apart,
/// it counts as failed: a machine that stalls that long must not drive motors. A worker that has ended is noticed at once
/// (`rescue`); this is for one that runs for ever.
const SILENT_LOOKS_MAX: u32 = 3;

/// The page's end of the link to its worker.
pub(crate) struct WorkerLink {
    worker: StartedWorker,
    /// Number of checks since the last ping, if there was one. Time alone is not enough: a page that hung has not
    /// received the messages that arrived meanwhile.
    silent_looks: Rc<Cell<Option<u32>>>,
}

impl WorkerLink {
    /// Starts the worker that the page names. `on_message` gets every message except for pings; `lost` is called when
    /// the worker has failed, after which no message arrives.
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
                    // At once and before anything else: a hidden page answers too, and a page whose
                    // handlers no longer run must not answer.
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

    /// Posts it the port for the line events.
    pub(crate) fn hand_over(&self, port: &MessagePort) {
        self.worker.hand_over(port);
    }

    /// Terminates it: it sends no more frames, and no message of it arrives.
    pub(crate) fn end(&self) {
        self.worker.end();
    }

    /// Checks whether the worker has stopped pinging.
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
