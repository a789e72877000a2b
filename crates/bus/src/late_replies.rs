//! Replies that may still arrive after their window.
//!
//! A reply does not name its request, and the two layouts differ in bytes 6 and 7. While a reply in
//! the other layout may still arrive, those bytes are not read. Time alone does not end the doubt:
//! an adapter or a delayed machine may hold replies for any time. But it delivers them in order, so
//! an outstanding reply comes before those of later requests: a few replies in their windows show
//! that none is outstanding.

use std::{collections::VecDeque, time::Duration};

use motorlink_protocol::{Instant, Layout};

use crate::timing::{FRESH_FOR, LATE_REPLY_MAX};

/// No reply is outstanding after as many replies as requests in a row were unanswered, plus this
/// many. On a machine with four times the load that it can carry, two exchanges in a row were seen
/// in which each request met the reply to the one before.
const REPLIES_MORE: u32 = 3;
/// At most this many: a motor that was absent has nothing outstanding.
const REPLIES_MAX: u32 = 8;
/// A request older than this has lost its reply: otherwise a line that loses many would be waited for on each.
const HELD_MAX: Duration = FRESH_FOR;

/// Outstanding replies of one motor, per layout.
#[derive(Clone, Debug, Default)]
pub(crate) struct LateReplies {
    drive: Outstanding,
    query: Outstanding,
    /// When the last unanswered requests were sent whose replies may still arrive, at most [`REPLIES_MAX`].
    sent: VecDeque<Instant>,
    /// When the last ID query was sent, while answers to it may still arrive.
    id_query: Option<Instant>,
    queries: QueriesInARow,
}

/// Replies to queries since the last other request.
///
/// Replies arrive in order. If more of them came in the windows of queries in a row than drive replies can be
/// outstanding, the last one answers a query, however recent the lost drive frame is.
#[derive(Clone, Copy, Debug, Default)]
struct QueriesInARow {
    /// When the last other request was sent.
    after: Option<Instant>,
    replies: u32,
    /// Drive replies that could be outstanding before the first of them.
    outstanding: u32,
}

#[derive(Clone, Copy, Debug, Default)]
struct Outstanding {
    /// When the last unanswered request was sent.
    sent: Option<Instant>,
    /// Replies to receive before none counts as outstanding.
    replies: u32,
}

impl LateReplies {
    /// Records a request without a reply in its window, the last of `in_a_row`.
    pub(crate) fn unanswered(&mut self, layout: Layout, sent: Instant, in_a_row: u32) {
        let outstanding = match layout {
            Layout::Drive => &mut self.drive,
            Layout::Query => &mut self.query,
        };
        let replies = in_a_row.saturating_add(REPLIES_MORE).min(REPLIES_MAX);
        if layout == Layout::Drive {
            self.queries.outstanding = self.queries.outstanding.max(replies);
        }
        *outstanding = Outstanding {
            sent: Some(sent),
            // Earlier outstanding replies stay outstanding.
            replies: replies.max(outstanding.replies),
        };
        if self.sent.len() >= REPLIES_MAX as usize {
            self.sent.pop_front();
        }
        self.sent.push_back(sent);
    }

    /// Records a request that a motor may answer in the layout of a drive reply.
    pub(crate) fn asked_otherwise(&mut self, now: Instant) {
        self.queries = QueriesInARow {
            after: Some(now),
            replies: 0,
            outstanding: self.drive.replies.max(REPLIES_MORE),
        };
    }

    /// When the last request other than a query was sent.
    pub(crate) const fn asked_otherwise_at(&self) -> Option<Instant> {
        self.queries.after
    }

    /// Records an ID query without an answer of this motor.
    pub(crate) fn id_query_unanswered(&mut self, sent: Instant) {
        self.unanswered(Layout::Drive, sent, 1);
        self.id_query = Some(sent);
    }

    /// Whether a reply outside its window may be several answers to an ID query at once. They may pass the CRC
    /// as a reply of no motor.
    pub(crate) const fn may_answer_id_query(&self) -> bool {
        self.id_query.is_some()
    }

    /// The same for a reply in its window.
    pub(crate) fn id_query_is_recent(&self, now: Instant) -> bool {
        self.id_query
            .is_some_and(|sent| now < sent + LATE_REPLY_MAX)
    }

    /// Records a reply outside its window.
    pub(crate) fn late_reply(&mut self) {
        self.sent.pop_front();
    }

    /// When the last unanswered request was sent, if a reply to it may arrive now.
    pub(crate) fn newest(&self, now: Instant) -> Option<Instant> {
        let may_come = |sent: &Instant| now.since(*sent) <= LATE_REPLY_MAX;
        self.sent.back().copied().filter(may_come)
    }

    /// When the oldest request was sent that a reply outside its window may answer.
    pub(crate) fn oldest(&self, now: Instant) -> Option<Instant> {
        let may_come = |sent: &Instant| now.since(*sent) < HELD_MAX;
        self.sent.iter().copied().find(may_come)
    }

    /// The replies that may arrive before that to a request sent now.
    pub(crate) fn outstanding(&self, now: Instant) -> usize {
        let may_come = |sent: &&Instant| now.since(**sent) < HELD_MAX;
        self.sent.iter().filter(may_come).count()
    }

    /// Records a reply to any request.
    pub(crate) fn replied(&mut self) {
        for outstanding in [&mut self.drive, &mut self.query] {
            outstanding.replies = outstanding.replies.saturating_sub(1);
        }
        if self.drive.replies == 0 && self.query.replies == 0 {
            self.sent.clear();
            self.id_query = None;
        }
    }

    /// The layout to read a reply in, to a request in `layout`; `None` while a reply in the other
    /// layout may still arrive. This reply was perhaps that one, so the reply to this request is
    /// outstanding as long.
    pub(crate) fn layout_of_reply(&mut self, now: Instant, layout: Layout) -> Option<Layout> {
        if layout == Layout::Query {
            self.queries.replies = self.queries.replies.saturating_add(1);
            if self.queries.replies > self.queries.outstanding {
                self.drive = Outstanding::default();
            }
        }
        let (own, other) = match layout {
            Layout::Drive => (&mut self.drive, &self.query),
            Layout::Query => (&mut self.query, &self.drive),
        };
        if !other.may_come(now) {
            return Some(layout);
        }
        own.sent = own.sent.or(other.sent);
        own.replies = own.replies.max(other.replies);
        None
    }

    /// Whether a late reply may still arrive.
    pub(crate) fn may_come(&self, now: Instant) -> bool {
        self.drive.may_come(now) || self.query.may_come(now)
    }

    /// Whether a lost reply is so recent that the next round trip is ambiguous (Karn's algorithm).
    pub(crate) fn makes_round_trip_ambiguous(&self, now: Instant) -> bool {
        self.drive.is_recent(now) || self.query.is_recent(now)
    }

    /// Whether every request so far was answered in its window.
    pub(crate) const fn all_answered_in_time(&self) -> bool {
        self.drive.sent.is_none() && self.query.sent.is_none()
    }

    /// Until when a query should wait for the reply to a drive frame.
    pub(crate) fn drive_expected_until(&self) -> Option<Instant> {
        self.drive.sent.map(|sent| sent + LATE_REPLY_MAX)
    }
}

impl Outstanding {
    fn may_come(&self, now: Instant) -> bool {
        self.replies > 0 || self.is_recent(now)
    }

    fn is_recent(&self, now: Instant) -> bool {
        self.sent.is_some_and(|sent| now < sent + LATE_REPLY_MAX)
    }
}

#[cfg(test)]
#[path = "late_replies_tests.rs"]
mod tests;
