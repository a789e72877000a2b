//! Reads records up to a time: the state and the packet log of what is before it.

use std::{collections::VecDeque, ops::Range};

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_protocol::Instant;
use motorlink_recorder::{ENTRIES_MAX, Log, WallClock};

use super::{replayed_state::State, times::Times};
use crate::{
    reader::{Cursor, Next, Session},
    record::{Record, What},
};

/// Records between two looks at the messages of the page: in a browser they take a millisecond.
const RECORDS_AT_ONCE: u32 = 256;

/// Times of frames that are kept for steps back.
const FRAMES_KEPT: usize = 1_024;

/// A place in the records, and what is before it.
#[derive(Debug)]
pub(super) struct Track {
    cursor: Cursor,
    times: Times,
    next: Option<(Instant, Record)>,
    is_at_end: bool,
    /// The time of the last record.
    pub(super) last: Instant,
    /// The time of the first record that it has read.
    pub(super) from: Option<Instant>,
    /// The bytes that it has asked for.
    wants: Option<Range<u64>>,
    /// Times of the last frames, each once.
    frames: VecDeque<Instant>,
    pub(super) state: State,
    pub(super) log: Log,
}

/// What a step of a track came to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    /// It needs these bytes.
    Read(Range<u64>),
    /// There is more to do.
    More,
    /// It is there.
    Reached,
}

impl Track {
    /// A track of the records from this time on, in nanoseconds since 1970; 0 is the beginning of the file.
    pub(super) fn at(session: &Session, times: Times, from_ns: u64, clock: WallClock) -> Self {
        let cursor = match from_ns {
            0 => Cursor::new(session),
            from_ns => Cursor::at(session, from_ns),
        };
        let mut log = Log::with_capacity(ENTRIES_MAX);
        log.set_clock(clock);
        Self {
            cursor,
            times,
            next: None,
            is_at_end: false,
            last: times.first,
            from: None,
            wants: None,
            frames: VecDeque::new(),
            state: State::new(),
            log,
        }
    }

    /// Whether there are no more records.
    pub(super) const fn is_at_end(&self) -> bool {
        self.is_at_end && self.next.is_none()
    }

    /// Takes bytes, if they are those that it has asked for. Returns whether they are.
    pub(super) fn supply(&mut self, range: &Range<u64>, bytes: &[u8]) -> bool {
        let wanted = self.wants.take_if(|wants| wants == range).is_some();
        if wanted {
            self.cursor.supply(bytes);
        }
        wanted
    }

    /// Takes the next records up to this time.
    pub(super) fn advance(&mut self, session: &Session, until: Instant) -> Progress {
        for _ in 0..RECORDS_AT_ONCE {
            if let Some(range) = self.look(session) {
                return Progress::Read(range);
            }
            match self.next.take_if(|(at, _)| *at <= until) {
                Some((at, record)) => self.take(at, &record),
                None => return Progress::Reached,
            }
        }
        Progress::More
    }

    /// Takes the next records up to a frame of the line after this time, without that frame. Its time, or the end, is
    /// [`Self::next_at`] then.
    pub(super) fn advance_to_frame(&mut self, session: &Session, after: Instant) -> Progress {
        let is_it = |next: &(Instant, Record)| next.0 > after && is_frame(&next.1);
        for _ in 0..RECORDS_AT_ONCE {
            if let Some(range) = self.look(session) {
                return Progress::Read(range);
            }
            match self.next.take_if(|next| !is_it(next)) {
                Some((at, record)) => self.take(at, &record),
                None => return Progress::Reached,
            }
        }
        Progress::More
    }

    /// The time of the next record; the end if there is none.
    pub(super) fn next_at(&self) -> Instant {
        self.next.as_ref().map_or(self.times.end, |(at, _)| *at)
    }

    /// The time of the last frame before this time, if it is kept.
    pub(super) fn frame_before(&self, at: Instant) -> Option<Instant> {
        self.frames.iter().rev().find(|frame| **frame < at).copied()
    }

    /// Looks at the next record. Returns the bytes that are needed for it.
    fn look(&mut self, session: &Session) -> Option<Range<u64>> {
        if self.next.is_some() || self.is_at_end {
            return None;
        }
        match self.cursor.next(session) {
            Next::Record(record) => {
                let at = self.times.limited(record.at, self.last);
                // The model is told before the records that were asked for.
                if !matches!(record.what, What::Line(LineEventKind::ModelSelected(_))) {
                    self.from.get_or_insert(at);
                }
                self.next = Some((at, record));
            }
            Next::Read(range) => {
                self.wants = Some(range.clone());
                return Some(range);
            }
            Next::End => self.is_at_end = true,
        }
        None
    }

    fn take(&mut self, at: Instant, record: &Record) {
        self.last = at;
        match &record.what {
            What::Line(kind) => self.log.add_event(&LineEvent { at, kind: *kind }),
            What::Event(event) => self.log.add_message(at, event.error, &event.text),
            What::State(_) => {}
        }
        self.state.add(at, &record.what);
        if is_frame(record) && self.frames.back() != Some(&at) {
            if self.frames.len() >= FRAMES_KEPT {
                self.frames.pop_front();
            }
            self.frames.push_back(at);
        }
    }
}

/// Whether it is a frame of the line, or its absence.
const fn is_frame(record: &Record) -> bool {
    match record.what {
        What::Line(kind) => kind.is_on_the_wire(),
        What::Event(_) | What::State(_) => false,
    }
}
