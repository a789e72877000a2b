//! The state of the recorder's worker, and its messages to the page.

use std::{cell::RefCell, collections::VecDeque, rc::Rc};

use motorlink_messages::{encode, recorder::FromRecorder};
use motorlink_protocol::Instant;
use motorlink_recorder::{Recorder, saved::Segment};

use super::{
    disk::Dir,
    found::Found,
    store::{Jobs, Store},
};
use crate::{
    blob_parts::Parts,
    scope::{self, Clock, report},
    turn_scheduler::TurnScheduler,
};

/// The state of this worker. Each callback of the browser borrows it once, briefly.
pub(super) struct RecorderWorker {
    pub(super) clock: Clock,
    pub(super) recorder: Recorder,
    pub(super) parts: Parts,
    pub(super) scheduler: TurnScheduler,
    pub(super) saving: Saving,
    /// Processes everything that is due; called when a file has been read.
    pub(super) turn: fn(&Shared),
    pub(super) utc_offset_asked: Instant,
}

pub(super) type Shared = Rc<RefCell<RecorderWorker>>;

/// The pending file operations of the recorder.
#[derive(Debug, Default)]
pub(super) struct Saving {
    pub(super) jobs: Jobs,
    /// `None` until the browser has opened its file system, and while a job runs.
    pub(super) store: Option<Store>,
    /// The browser has no file system.
    pub(super) is_in_memory_only: bool,
    /// The saved session that is offered to the user.
    pub(super) found: Option<Found>,
    /// Number of times that everything was erased: a search that began before offers nothing.
    pub(super) erased: u32,
    /// The files of the restored session that have not been read yet.
    pub(super) to_read: Option<(Dir, VecDeque<Segment>)>,
}

pub(super) fn post(message: &FromRecorder) {
    match encode(message) {
        Ok(bytes) => scope::post_bytes(&bytes),
        Err(error) => report("a message could not be encoded", &error.to_string().into()),
    }
}
