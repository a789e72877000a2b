//! Replies that may still come though their window is spent.
//!
//! A reply does not say what it answers, and the two layouts differ in bytes 6 and 7: while a reply in
//! the other layout may still come, those two are not read. Time alone does not tell: an adapter, or a
//! machine that is held up, may hand out what it has held for as long as it likes. But it hands it out in
//! order, so a reply that is owed comes before those of later requests: a few replies in time say that
//! none is owed.

use motorlink_protocol::{Instant, Layout};

use crate::timing::LATE_REPLY_MAX;

/// As many replies as one request after the other was left without, and so many more, say that none is
/// owed. On a machine with four times the work that it can do, two exchanges in a row were seen in which
/// each request was met by the reply to the one before it.
const REPLIES_MORE: u32 = 3;
/// But not more than this: a motor that was away owes nothing.
const REPLIES_MAX: u32 = 8;

/// What one motor may owe in either layout.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LateReplies {
    drive: Owed,
    query: Owed,
}

#[derive(Clone, Copy, Debug, Default)]
struct Owed {
    /// When the last request without reply was sent.
    sent: Option<Instant>,
    /// Replies that are to come before none is owed.
    replies: u32,
}

impl LateReplies {
    /// A request had no reply in its window; it was the last of so many in a row.
    pub(crate) fn unanswered(&mut self, layout: Layout, sent: Instant, in_a_row: u32) {
        let owed = match layout {
            Layout::Drive => &mut self.drive,
            Layout::Query => &mut self.query,
        };
        let replies = in_a_row.saturating_add(REPLIES_MORE).min(REPLIES_MAX);
        *owed = Owed {
            sent: Some(sent),
            // What was owed before is owed still.
            replies: replies.max(owed.replies),
        };
    }

    /// A reply came, to whatever request.
    pub(crate) fn replied(&mut self) {
        for owed in [&mut self.drive, &mut self.query] {
            owed.replies = owed.replies.saturating_sub(1);
        }
    }

    /// The layout in which a reply to a request in `layout` can be read now: none while one in the other
    /// may still come. Then this reply was perhaps that one, and the one to this request is owed as long.
    pub(crate) fn layout_of_reply(&mut self, now: Instant, layout: Layout) -> Option<Layout> {
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

    /// Whether any may still come.
    pub(crate) fn may_come(&self, now: Instant) -> bool {
        self.drive.may_come(now) || self.query.may_come(now)
    }

    /// Whether one is so recent that the next reply's time says nothing of the line (Karn's algorithm).
    pub(crate) fn blurs_round_trips(&self, now: Instant) -> bool {
        self.drive.is_recent(now) || self.query.is_recent(now)
    }

    /// Whether every request so far had its reply in its window.
    pub(crate) const fn none_was_ever_owed(&self) -> bool {
        self.drive.sent.is_none() && self.query.sent.is_none()
    }

    /// Until when a query had better wait for the reply to a drive frame.
    pub(crate) fn drive_expected_until(&self) -> Option<Instant> {
        self.drive.sent.map(|sent| sent + LATE_REPLY_MAX)
    }
}

impl Owed {
    fn may_come(&self, now: Instant) -> bool {
        self.replies > 0 || self.is_recent(now)
    }

    fn is_recent(&self, now: Instant) -> bool {
        self.sent.is_some_and(|sent| now < sent + LATE_REPLY_MAX)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn at(ms: u64) -> Instant {
        Instant::ZERO + Duration::from_millis(ms)
    }

    #[test]
    fn a_lost_reply_leaves_its_own_layout_certain() {
        let mut late = LateReplies::default();
        late.unanswered(Layout::Query, at(0), 1);
        assert_eq!(
            late.layout_of_reply(at(9), Layout::Query),
            Some(Layout::Query)
        );
        assert_eq!(late.layout_of_reply(at(9), Layout::Drive), None);
    }

    #[test]
    fn neither_time_alone_nor_replies_alone_end_the_doubt() {
        let mut late = LateReplies::default();
        late.unanswered(Layout::Drive, at(0), 1);
        assert_eq!(late.layout_of_reply(at(9_999), Layout::Query), None);
        for _ in 0..3 {
            late.replied();
            assert!(late.may_come(at(9_999)));
        }
        late.replied();
        assert_eq!(late.layout_of_reply(at(49), Layout::Query), None);
        assert_eq!(
            late.layout_of_reply(at(50), Layout::Query),
            Some(Layout::Query)
        );
        assert!(!late.may_come(at(50)));
    }

    #[test]
    fn what_is_owed_is_not_forgotten_for_a_smaller_debt() {
        let mut late = LateReplies::default();
        late.unanswered(Layout::Drive, at(0), 5);
        late.replied();
        late.unanswered(Layout::Drive, at(20), 1);
        for _ in 0..6 {
            late.replied();
        }
        assert!(late.may_come(at(9_999)));
        late.replied();
        assert!(!late.may_come(at(9_999)));
    }

    /// Each request is met by the reply to the one before it.
    #[test]
    fn one_that_was_met_by_another_is_owed_as_long() {
        let mut late = LateReplies::default();
        late.unanswered(Layout::Drive, at(0), 1);
        late.replied();
        assert_eq!(late.layout_of_reply(at(100), Layout::Query), None);
        late.replied();
        assert_eq!(late.layout_of_reply(at(120), Layout::Drive), None);
        late.replied();
        late.replied();
        assert_eq!(
            late.layout_of_reply(at(140), Layout::Drive),
            Some(Layout::Drive)
        );
    }

    #[test]
    fn one_that_was_long_away_is_soon_believed() {
        let mut late = LateReplies::default();
        late.unanswered(Layout::Drive, at(0), 900);
        let replies = (0..20).take_while(|_| {
            late.replied();
            late.may_come(at(9_999))
        });
        assert_eq!(replies.count(), 7);
    }
}
