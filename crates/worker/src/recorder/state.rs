//! What the recorder's worker consists of, and how it reaches the page.

use std::{cell::RefCell, collections::VecDeque, rc::Rc};

use js_sys::Date;
use motorlink_messages::{encode, recorder::FromRecorder};
use motorlink_protocol::Instant;
use motorlink_recorder::{LocalTime, Recorder, kept::Segment};

use super::{
    again::Again,
    disk::Dir,
    files::Parts,
    found::Found,
    store::{Jobs, Store},
};
use crate::scope::{self, Clock, report};

/// Everything that this worker is. Each callback of the browser borrows it once, briefly.
pub(super) struct RecorderWorker {
    pub(super) clock: Clock,
    pub(super) recorder: Recorder,
    pub(super) parts: Parts,
    pub(super) again: Again,
    pub(super) keeping: Keeping,
    /// Does what is due; called when a file has been read.
    pub(super) turn: fn(&Shared),
    pub(super) utc_offset_asked: Instant,
}

pub(super) type Shared = Rc<RefCell<RecorderWorker>>;

/// What stands between the recorder and its files.
#[derive(Debug, Default)]
pub(super) struct Keeping {
    pub(super) jobs: Jobs,
    /// Not there until the browser has given its files, and while a job is being done.
    pub(super) store: Option<Store>,
    /// The browser keeps no files.
    pub(super) is_in_memory_only: bool,
    /// The session that is offered.
    pub(super) found: Option<Found>,
    /// How often everything was erased: what was looked for before is not offered.
    pub(super) erased: u32,
    /// The files of the session that is restored that have not been read yet.
    pub(super) to_read: Option<(Dir, VecDeque<Segment>)>,
}

pub(super) fn tell(message: &FromRecorder) {
    match encode(message) {
        Ok(bytes) => scope::post_bytes(&bytes),
        Err(error) => report("a message could not be encoded", &error.to_string().into()),
    }
}

/// How far local time is ahead of UTC, from this moment until now, in milliseconds since 1970.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "milliseconds since 1970 are exact in a double, and no place is a day ahead"
)]
pub(super) fn local_time(from_ms: i64) -> LocalTime {
    LocalTime::between(from_ms, Date::now() as i64, |unix_ms| {
        -Date::new(&(unix_ms as f64).into()).get_timezone_offset() as i32
    })
}
