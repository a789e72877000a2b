//! The session worker in the browser: saves what the recorder keeps as a session file, and opens such files.
//!
//! | file | what it holds |
//! |---|---|
//! | `saving` | from the recorder to a file |
//! | `target` | the file that is written |
//! | `opening` | opens a file |
//! | `open_session` | a file that is open |
//! | `reading` | reads its records, and writes other files from them |
//! | `runs` | the runs of experiments in a file |
//! | `copying` | copies it with other bookmarks |
//! | `replay`, `replaying` | the replay of an open file |
//! | `source` | the bytes of an open file |
//! | `state` | the state of the worker, and its messages to the page |
//! | `info` | what the page shows of an open file |

mod copying;
mod info;
mod open_session;
mod opening;
mod reading;
mod replay;
mod replaying;
mod runs;
mod saving;
mod source;
mod state;
mod target;

use std::{cell::RefCell, rc::Rc};

use js_sys::{Array, Uint8Array};
use motorlink_messages::{
    decode,
    sessions::{FromSessions, NotSaved, ToSessions},
};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use wasm_bindgen_futures::spawn_local;
use web_sys::{File, MessageEvent, MessagePort};

use self::state::{SessionWorker, Shared, begin_reading, post};
use crate::scope::{Clock, global, report};

/// Starts the worker.
pub(crate) fn start() {
    let shared: Shared = Rc::new(RefCell::new(SessionWorker {
        clock: Clock::new(),
        is_saving: false,
        wake: None,
        reading: 0,
        open: None,
        replay: None,
    }));
    let handler = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        let parts: Array = event.data().unchecked_into();
        let bytes = Uint8Array::new(&parts.get(0)).to_vec();
        match decode::<ToSessions>(&bytes) {
            Ok(message) => handle(&shared, message, &parts),
            Err(error) => report(
                "the page sent a message of another build",
                &error.to_string().into(),
            ),
        }
    });
    global().set_onmessage(Some(handler.as_ref().unchecked_ref()));
    handler.forget();
}

/// Tells the page that the worker has failed.
pub(crate) fn died() {
    post(&FromSessions::Died);
}

/// Handles a message of the page; `parts` are what was posted with it.
fn handle(shared: &Shared, message: ToSessions, parts: &Array) {
    match message {
        ToSessions::Save {
            version,
            setup,
            rover,
            range,
        } => {
            // The channel is the last one.
            let Ok(recorder) = parts.pop().dyn_into::<MessagePort>() else {
                return post(&FromSessions::NotSaved(NotSaved::NoRecorder));
            };
            let handle = parts.get(1).dyn_into().ok();
            if std::mem::replace(&mut shared.borrow_mut().is_saving, true) {
                return;
            }
            let shared = Rc::clone(shared);
            spawn_local(async move {
                let order = saving::SaveOrder {
                    version,
                    setup,
                    rover,
                    range,
                };
                saving::save(&shared, recorder, handle, &order).await;
            });
        }
        ToSessions::CancelSave => {
            let wake = {
                let worker = &mut *shared.borrow_mut();
                worker.is_saving = false;
                worker.wake.take()
            };
            if let Some(wake) = wake {
                // It ends the wait; what it returns says nothing.
                let _ = wake.call0(&JsValue::UNDEFINED);
            }
        }
        ToSessions::Open { name } => {
            let Ok(file) = parts.get(1).dyn_into::<File>() else {
                return post(&FromSessions::Cancelled);
            };
            let (shared, task) = (Rc::clone(shared), begin_reading(shared));
            spawn_local(async move { opening::open(&shared, task, name, file).await });
        }
        ToSessions::Export(what) => {
            let Some(open) = shared.borrow().open.clone() else {
                return post(&FromSessions::Cancelled);
            };
            let (shared, task) = (Rc::clone(shared), begin_reading(shared));
            spawn_local(async move { reading::export(&shared, task, &open, what).await });
        }
        ToSessions::SaveCopy(bookmarks) => {
            let Some(open) = shared.borrow().open.clone() else {
                return post(&FromSessions::Cancelled);
            };
            let (shared, task) = (Rc::clone(shared), begin_reading(shared));
            spawn_local(async move { copying::copy(&shared, task, &open, &bookmarks).await });
        }
        ToSessions::KeepRuns => {
            let Some(open) = shared.borrow().open.clone() else {
                return post(&FromSessions::Cancelled);
            };
            let (shared, task) = (Rc::clone(shared), begin_reading(shared));
            spawn_local(async move { runs::keep(&shared, task, &open).await });
        }
        ToSessions::CancelReading => {
            begin_reading(shared);
            post(&FromSessions::Cancelled);
        }
        ToSessions::Replay(message) => replaying::handle(shared, message),
    }
}
