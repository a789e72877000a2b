//! The state of the session worker, and its messages to the page.

use std::{cell::RefCell, rc::Rc, time::Duration};

use js_sys::Function;
use motorlink_messages::{
    encode,
    sessions::{FromSessions, Progress},
};
use motorlink_protocol::Instant;
use wasm_bindgen::JsValue;

use super::{
    open_session::{NotOpened, OpenSession},
    replay::Replay,
};
use crate::{
    blob_parts::Parts,
    scope::{self, Clock, report},
};

/// Progress is reported ten times a second.
const PROGRESS_PERIOD: Duration = Duration::from_millis(100);

/// The state of this worker. Each callback and each step of a task borrows it once, briefly.
pub(super) struct SessionWorker {
    pub(super) clock: Clock,
    /// Whether a session is being saved.
    pub(super) is_saving: bool,
    /// Ends the wait for the recorder, while a session is being saved.
    pub(super) wake: Option<Function>,
    /// The number of the present task that reads. A task whose number is not the present one ends.
    pub(super) reading: u32,
    pub(super) open: Option<Rc<OpenSession>>,
    /// The replay of the open session.
    pub(super) replay: Option<Replay>,
}

pub(super) type Shared = Rc<RefCell<SessionWorker>>;

/// Ends the present task that reads. Returns the number of the next one.
pub(super) fn begin_reading(shared: &Shared) -> u32 {
    let worker = &mut *shared.borrow_mut();
    worker.reading = worker.reading.wrapping_add(1);
    worker.reading
}

/// Whether this task that reads has been ended.
pub(super) fn is_ended(shared: &Shared, task: u32) -> bool {
    shared.borrow().reading != task
}

/// Reports progress to the page, now and then.
pub(super) struct Reporter {
    clock: Clock,
    reported: Option<Instant>,
    message: fn(Progress) -> FromSessions,
}

impl Reporter {
    pub(super) fn new(shared: &Shared, message: fn(Progress) -> FromSessions) -> Self {
        Self {
            clock: shared.borrow().clock.clone(),
            reported: None,
            message,
        }
    }

    pub(super) fn report(&mut self, done: u64, of: u64) {
        let now = self.clock.now();
        if self
            .reported
            .is_none_or(|at| now.since(at) >= PROGRESS_PERIOD)
        {
            self.reported = Some(now);
            post(&(self.message)(Progress { done, of }));
        }
    }
}

pub(super) fn post(message: &FromSessions) {
    match encode(message) {
        Ok(bytes) => scope::post_bytes(&bytes),
        Err(error) => report("a message could not be encoded", &error.to_string().into()),
    }
}

/// Tells the page why a file was not opened or exported. A cancelled task posts nothing.
pub(super) fn post_not_opened(why: &NotOpened) {
    match why {
        NotOpened::NotASession(why) => post(&FromSessions::NotOpened(Some(*why))),
        NotOpened::Unreadable => post(&FromSessions::NotOpened(None)),
        NotOpened::NoRoom => post(&FromSessions::NoRoom),
        NotOpened::Ended => {}
    }
}

/// Posts a message with the file of these parts.
pub(super) fn post_file(
    message: &FromSessions,
    parts: &mut Parts,
    media_type: &str,
) -> Result<(), JsValue> {
    let bytes = encode(message).map_err(|error| JsValue::from(error.to_string()))?;
    parts.post_as_file(&bytes, media_type)
}
