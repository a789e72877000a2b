//! Which replies are outstanding, and in which layout a reply is read meanwhile.

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

/// A frame that comes so long after it answers something else, or a computer has stalled.
#[test]
fn a_request_of_long_ago_widens_no_window() {
    let mut late = LateReplies::default();
    late.unanswered(Layout::Query, at(100), 1);
    late.unanswered(Layout::Query, at(120), 2);
    assert_eq!(late.newest(at(170)), Some(at(120)));
    assert_eq!(late.newest(at(171)), None);
}

#[test]
fn five_missing_replies_are_not_forgotten_when_one_more_is_missing() {
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

/// Each request meets the reply to the one before it.
#[test]
fn a_reply_to_the_request_before_does_not_end_the_wait() {
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
fn a_reply_outside_its_window_is_no_longer_outstanding() {
    let mut late = LateReplies::default();
    late.unanswered(Layout::Query, at(0), 1);
    late.unanswered(Layout::Drive, at(9), 2);
    assert_eq!(late.outstanding(at(99)), 2);
    // One in its window may be either of them.
    late.replied();
    assert_eq!(late.outstanding(at(99)), 2);
    late.late_reply();
    late.replied();
    assert_eq!(late.outstanding(at(99)), 1);
    assert_eq!(late.outstanding(at(508)), 1);
    assert_eq!(late.outstanding(at(509)), 0);
    for _ in 0..3 {
        late.replied();
    }
    assert_eq!(late.outstanding(at(99)), 0);
}

#[test]
fn replies_in_one_layout_are_outstanding_without_any_in_the_other() {
    for layout in [Layout::Drive, Layout::Query] {
        let mut late = LateReplies::default();
        late.unanswered(layout, at(9), 1);
        late.replied();
        assert_eq!(late.outstanding(at(99)), 1, "{layout:?}");
        assert_eq!(late.oldest(at(508)), Some(at(9)));
        assert_eq!(late.oldest(at(509)), None);
    }
}

/// At most four replies to drive frames come before those to the queries.
#[test]
fn the_fifth_reply_to_queries_in_a_row_answers_a_query() {
    let mut late = LateReplies::default();
    late.asked_otherwise(at(0));
    late.unanswered(Layout::Drive, at(0), 1);
    for ms in 1..=4 {
        assert_eq!(late.layout_of_reply(at(ms), Layout::Query), None, "{ms}");
    }
    let query = Some(Layout::Query);
    assert_eq!(late.layout_of_reply(at(5), Layout::Query), query);
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

#[test]
fn a_lost_reply_is_known_by_its_layout_and_recent_for_50_ms() {
    for layout in [Layout::Drive, Layout::Query] {
        let mut late = LateReplies::default();
        assert!(late.all_answered_in_time() && !late.may_come(at(1)));
        assert_eq!(late.drive_expected_until(), None);
        late.unanswered(layout, at(1), 1);
        assert!(!late.all_answered_in_time());
        assert!(late.makes_round_trip_ambiguous(at(50)), "{layout:?}");
        assert!(!late.makes_round_trip_ambiguous(at(51)), "{layout:?}");
        let expected = (layout == Layout::Drive).then_some(at(51));
        assert_eq!(late.drive_expected_until(), expected);
    }
}

#[test]
fn answers_to_an_id_query_may_come_until_four_replies_in_their_windows() {
    let mut late = LateReplies::default();
    assert!(!late.may_answer_id_query() && !late.id_query_is_recent(at(1)));
    late.id_query_unanswered(at(1));
    assert!(late.id_query_is_recent(at(50)) && !late.id_query_is_recent(at(51)));
    assert_eq!(late.layout_of_reply(at(2), Layout::Query), None);
    for _ in 0..3 {
        late.replied();
        assert!(late.may_answer_id_query());
    }
    late.replied();
    assert!(!late.may_answer_id_query() && !late.id_query_is_recent(at(2)));
}

#[test]
fn the_newest_eight_lost_replies_are_outstanding() {
    let mut late = LateReplies::default();
    for ms in 0..10 {
        late.unanswered(Layout::Query, at(ms), 1);
    }
    assert_eq!(late.outstanding(at(10)), 8);
    assert_eq!(
        late.outstanding(at(502)),
        7,
        "the first of them was sent at 2 ms"
    );
}
