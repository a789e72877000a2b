//! Bookmarks, and those of an overview.

use std::{collections::VecDeque, time::Duration};

use motorlink_messages::sessions::Bookmark;
use motorlink_protocol::Instant;

use crate::{
    overview::{BOOKMARKS_MAX, MARKS_MAX, Mark, Overview},
    record::EventKind,
};

/// Letters of a note: a paragraph.
pub const BOOKMARK_TEXT_MAX: usize = 1_000;

/// In the order of time, within the bounds.
pub(super) fn sorted(bookmarks: &[Bookmark]) -> Vec<Bookmark> {
    let mut sorted: Vec<Bookmark> = Vec::new();
    for bookmark in bookmarks.iter().take(BOOKMARKS_MAX) {
        let mut bookmark = bookmark.clone();
        let end = bookmark.text.char_indices().nth(BOOKMARK_TEXT_MAX);
        if let Some((end, _)) = end {
            bookmark.text.truncate(end);
        }
        let place = sorted.partition_point(|other| other.after_us <= bookmark.after_us);
        sorted.insert(place, bookmark);
    }
    sorted
}

/// The overview with these bookmarks, in the order of time, instead of its own.
pub(super) fn with_bookmarks(overview: &Overview, bookmarks: &[Bookmark]) -> Overview {
    let mut copy = overview.clone();
    let others = overview
        .marks()
        .iter()
        .filter(|mark| mark.kind != EventKind::Bookmark);
    // The bookmarks are of the user: other events give way.
    let room = MARKS_MAX.saturating_sub(bookmarks.len());
    let left_out = others.clone().count().saturating_sub(room);
    let mut marks: Vec<_> = others.take(room).cloned().collect();
    for bookmark in bookmarks {
        let after = Duration::from_micros(bookmark.after_us);
        let place = marks.partition_point(|mark| mark.after <= after);
        let mark = Mark {
            after,
            kind: EventKind::Bookmark,
            error: false,
            text: bookmark.text.clone(),
        };
        marks.insert(place, mark);
    }
    copy.set_marks(marks, left_out as u64);
    copy
}

/// Bookmarks that are not written.
#[derive(Debug)]
pub(super) struct Pending {
    rest: VecDeque<(Instant, String)>,
    /// The last time on both clocks: the monotonic one, and in nanoseconds since 1970, UTC.
    last: (Instant, u64),
}

impl Pending {
    pub(super) fn new(bookmarks: &[Bookmark], first: (Instant, u64)) -> Self {
        let rest = bookmarks.iter().map(|bookmark| {
            let at = first.0 + Duration::from_micros(bookmark.after_us);
            (at, bookmark.text.clone())
        });
        Self {
            rest: rest.collect(),
            last: first,
        }
    }

    /// The next one before this time of a record, or the next one: its time on both clocks, and its text.
    pub(super) fn next(&mut self, before: Option<Instant>) -> Option<(Instant, u64, String)> {
        let (at, _) = self.rest.front()?;
        if before.is_some_and(|before| *at >= before) {
            return None;
        }
        let (at, text) = self.rest.pop_front()?;
        let (last, utc_ns) = self.last;
        let micros = at.as_micros().saturating_sub(last.as_micros());
        Some((
            at,
            utc_ns.saturating_add(micros.saturating_mul(1_000)),
            text,
        ))
    }

    /// A record has this time on both clocks.
    pub(super) const fn pass(&mut self, at: Instant, utc_ns: u64) {
        self.last = (at, utc_ns);
    }
}
