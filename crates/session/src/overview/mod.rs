//! A summary of the whole session over time: least and greatest values of each bucket of time, marks, and totals.
//!
//! It is computed while a session is written and stored in the file, so that the first picture needs no frames. For a
//! file without one, such as a truncated file, all records are read once.

mod faults;
mod motor;
mod stored;

use std::{collections::BTreeMap, time::Duration};

use motorlink_bus::{LineEvent, LineEventKind, LineSamples};
use motorlink_messages::{Update, sessions::FaultChange};
use motorlink_protocol::{
    Instant, MotorId, Reply,
    family::{Model, Reading, Request},
};

use crate::record::{EventKind, Record, STATE_HOLDS, What};

use faults::FaultChanges;

pub use motor::{Extent, MotorOverview};

/// Maximal number of buckets: more than a timeline has pixels.
pub const BUCKETS_MAX: usize = 2_048;

/// Maximal number of marks. Later ones are only counted.
pub const MARKS_MAX: usize = 4_096;

/// Bookmarks of a file: more than a person sets.
pub const BOOKMARKS_MAX: usize = 1_000;

/// Initial length of a bucket in microseconds. It doubles whenever there are too many buckets.
const BUCKET_US: u64 = 1_000;

/// A summary of the whole session over time. Two are equal if they are stored alike.
#[derive(Clone, Debug)]
pub struct Overview {
    /// Length of a bucket in microseconds.
    bucket_us: u64,
    /// The time of the first record, on both clocks.
    first: Option<(Instant, u64)>,
    last: Option<(Instant, u64)>,
    motors: BTreeMap<MotorId, MotorOverview>,
    faults: FaultChanges,
    marks: Vec<Mark>,
    /// How many of the marks are bookmarks.
    bookmarks: usize,
    /// Reads the following records. It is not stored.
    samples: LineSamples,
    /// Number of marks beyond [`MARKS_MAX`].
    pub marks_left_out: u64,
    /// Frames and other events of the bus.
    pub line_events: u64,
    /// Frames sent.
    pub sent: u64,
    /// Valid frames received.
    pub received: u64,
    /// Requests without a reply.
    pub lost: u64,
    /// Pieces of junk: bytes that are not a frame.
    pub junk: u64,
    /// Frames that the port refused.
    pub not_sent: u64,
}

impl Default for Overview {
    fn default() -> Self {
        Self {
            bucket_us: BUCKET_US,
            first: None,
            last: None,
            motors: BTreeMap::new(),
            faults: FaultChanges::default(),
            marks: Vec::new(),
            bookmarks: 0,
            samples: LineSamples::default(),
            marks_left_out: 0,
            line_events: 0,
            sent: 0,
            received: 0,
            lost: 0,
            junk: 0,
            not_sent: 0,
        }
    }
}

impl PartialEq for Overview {
    fn eq(&self, other: &Self) -> bool {
        self.to_json() == other.to_json()
    }
}

/// An event on the timeline.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mark {
    /// Time since the first record of the session.
    pub after: Duration,
    /// Kind of the event.
    pub kind: EventKind,
    /// Whether it is an error.
    pub error: bool,
    /// Its text.
    pub text: String,
}

impl Overview {
    /// The session reaches this time. Returns its first.
    pub(crate) fn reach(&mut self, at: Instant, utc_ns: u64) -> Instant {
        let (first, _) = *self.first.get_or_insert((at, utc_ns));
        if let Some((last, _)) = self.last
            && at.since(last) > STATE_HOLDS
        {
            self.faults.gap(last + STATE_HOLDS);
        }
        if self.last.is_none_or(|(last, _)| at >= last) {
            self.last = Some((at, utc_ns));
        }
        first
    }

    /// Takes the next record.
    pub fn add(&mut self, record: &Record) {
        let first = self.reach(record.at, record.utc_ns);
        let after = record.at.since(first);
        match &record.what {
            What::Line(kind) => {
                let (at, kind) = (record.at, *kind);
                if let Some(sample) = self.samples.add_event(&LineEvent { at, kind }) {
                    self.faults.frame(&sample);
                    self.replied(after, &sample.reply);
                }
                if let LineEventKind::Silence { id, .. } = kind {
                    self.faults.silence(at, id);
                }
                self.line(&kind);
            }
            What::Event(event) => {
                if event.kind == EventKind::Disconnected {
                    self.faults.end_all(record.at);
                }
                if self.has_room_for(event.kind) {
                    self.bookmarks += usize::from(event.kind == EventKind::Bookmark);
                    self.marks.push(Mark {
                        after,
                        kind: event.kind,
                        error: event.error,
                        text: event.text.clone(),
                    });
                } else {
                    self.marks_left_out += 1;
                }
            }
            What::State(update) => self.faults.state(update),
        }
    }

    /// Takes what the page showed.
    pub(crate) fn state(&mut self, update: &Update, utc_ns: u64) {
        self.reach(update.now, utc_ns);
        self.faults.state(update);
    }

    /// Whether another mark of this kind has room. Bookmarks are of the user, and a copy of the file has only those of
    /// the overview: other events give way.
    fn has_room_for(&mut self, kind: EventKind) -> bool {
        if kind != EventKind::Bookmark {
            return self.marks.len() < MARKS_MAX;
        }
        if self.bookmarks == BOOKMARKS_MAX {
            return false;
        }
        if self.marks.len() == MARKS_MAX {
            let mut kinds = self.marks.iter().map(|mark| mark.kind);
            if let Some(last) = kinds.rposition(|kind| kind != EventKind::Bookmark) {
                self.marks.remove(last);
                self.marks_left_out += 1;
            }
        }
        true
    }

    fn line(&mut self, kind: &LineEventKind) {
        self.line_events += u64::from(kind.is_on_the_wire());
        match kind {
            LineEventKind::Sent { frame, .. }
            | LineEventKind::SentByHand { frame, .. }
            | LineEventKind::RepeatedByHand { frame, .. } => {
                self.sent += 1;
                let request = Request::parse(self.samples.model(), frame).ok();
                if let Some(id) = request.and_then(|one| one.addressee()) {
                    self.motor(id).sent += 1;
                }
            }
            LineEventKind::Received { frame, .. } => {
                self.received += 1;
                let [address, ..] = *frame.bytes();
                let reading = Reading::decode(self.samples.model(), frame, None);
                if let (Ok(_), Ok(id)) = (reading, MotorId::new(address)) {
                    self.motor(id).replies += 1;
                }
            }
            LineEventKind::Known { .. } | LineEventKind::ModelSelected(_) => {}
            LineEventKind::Junk(_) => self.junk += 1,
            LineEventKind::Silence { id, .. } => {
                self.lost += 1;
                self.motor(*id).lost += 1;
            }
            LineEventKind::NotSent { .. } => self.not_sent += 1,
        }
    }

    /// The following records are of this model.
    pub(crate) fn set_model(&mut self, model: Model) {
        self.samples = LineSamples::of(model);
    }

    fn replied(&mut self, after: Duration, reply: &Reply) {
        let bucket = self.bucket_of(after);
        let scale = self.samples.model().spec().current;
        let reply = Reply {
            current: reply.current.filter(|_| scale.is_certain()),
            ..*reply
        };
        self.motor(reply.id).replied(bucket, &reply);
    }

    fn motor(&mut self, id: MotorId) -> &mut MotorOverview {
        self.motors.entry(id).or_default()
    }

    /// The bucket of a time. Doubles the buckets until there are not too many.
    fn bucket_of(&mut self, after: Duration) -> usize {
        let after_us = u64::try_from(after.as_micros()).unwrap_or(u64::MAX);
        while after_us / self.bucket_us >= BUCKETS_MAX as u64 {
            self.bucket_us = self.bucket_us.saturating_mul(2);
            for motor in self.motors.values_mut() {
                motor.double_buckets();
            }
        }
        usize::try_from(after_us / self.bucket_us).unwrap_or_default()
    }

    /// Length of a bucket.
    #[must_use]
    pub const fn bucket(&self) -> Duration {
        Duration::from_micros(self.bucket_us)
    }

    /// Time from the first to the last record.
    #[must_use]
    pub fn duration(&self) -> Duration {
        match (self.first, self.last) {
            (Some((first, _)), Some((last, _))) => last.since(first),
            _ => Duration::ZERO,
        }
    }

    /// The time of the first record on the monotonic clock, and in nanoseconds since 1970, UTC.
    #[must_use]
    pub const fn begins(&self) -> Option<(Instant, u64)> {
        self.first
    }

    /// The times of the first and the last record, in nanoseconds since 1970, UTC.
    #[must_use]
    pub fn span_ns(&self) -> Option<(u64, u64)> {
        Some((self.first?.1, self.last?.1))
    }

    /// Every motor that replied, or that lost a request. An address that was only scanned is no motor: a scan reports no
    /// lost request.
    pub fn motors(&self) -> impl Iterator<Item = (MotorId, &MotorOverview)> {
        let motors = self.motors.iter().map(|(id, motor)| (*id, motor));
        motors.filter(|(_, motor)| motor.replies > 0 || motor.lost > 0)
    }

    /// The changes of the faults that motors report, oldest first; of a long session the newest.
    #[must_use]
    pub fn fault_changes(&self) -> &[FaultChange] {
        self.faults.all()
    }

    /// Replaces the events, and adds to the number of those that are left out.
    pub(crate) fn set_marks(&mut self, marks: Vec<Mark>, left_out: u64) {
        self.bookmarks = bookmarks_in(&marks);
        self.marks = marks;
        self.marks_left_out += left_out;
    }

    /// Events, in their order.
    #[must_use]
    pub fn marks(&self) -> &[Mark] {
        &self.marks
    }
}

fn bookmarks_in(marks: &[Mark]) -> usize {
    let bookmarks = marks.iter().filter(|mark| mark.kind == EventKind::Bookmark);
    bookmarks.count()
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
