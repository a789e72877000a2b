//! Filters of the log.

use motorlink_messages::recorder::{Filter, Kind, Window};
use motorlink_protocol::{Instant, Request, Setpoint, SpeedTarget};
use motorlink_recorder::Log;

use crate::line::{
    at, by_hand, collapsed, drive, driven, finish, id, junk, log, meanings, newest, of_kind, query,
    reply, silence, text,
};

fn millis(at: u64) -> Instant {
    Instant::from_millis(at)
}

#[test]
fn filters_leave_out_what_is_not_asked_for() {
    let mut log = log(100);
    for passed in [
        drive(1, 50),
        reply(1, 0),
        drive(2, -50),
        silence(2),
        junk(&[5; 10]),
    ] {
        log.add_event(&at(0, passed));
    }
    log.add_message(millis(1), false, "connected to motor 2");
    let mut shown = |filter: &Filter| {
        log.filter(filter);
        newest(&log).rows.len()
    };
    assert_eq!(shown(&Filter::default()), 6);
    assert_eq!(shown(&text("DRIVE")), 2);
    assert_eq!(shown(&text("-50")), 1);
    assert_eq!(shown(&text("0x02")), 2);
    assert_eq!(shown(&text("motor 2")), 1);
    assert_eq!(shown(&of_kind(Kind::Error)), 2);
    assert_eq!(shown(&of_kind(Kind::System)), 1);
    let of_2 = Filter {
        id: Some(id(2)),
        ..Filter::default()
    };
    assert_eq!(shown(&of_2), 2);
    let driven_2 = Filter {
        text: "drive".into(),
        ..of_2
    };
    assert_eq!(shown(&driven_2), 1);
}

#[test]
fn a_filter_counts_its_rows_again_and_says_so() {
    let mut log = log(100);
    for n in 0..10 {
        log.add_event(&driven(n));
    }
    let before = newest(&log);
    log.filter(&of_kind(Kind::Rx));
    let after = newest(&log);
    assert_eq!(after.generation, before.generation + 1);
    assert_eq!(after.end - after.oldest, 5);
    assert_eq!(after.kept, 10);
    log.clear();
    assert_eq!(newest(&log).generation, after.generation + 1);
}

#[test]
fn routine_is_hidden_and_counted_and_comes_back() {
    let mut log = log(1_000);
    log.filter(&collapsed());
    let mut passed = vec![drive(1, 50), reply(1, 0)];
    passed.extend([drive(1, 50), reply(1, 1), query(1), reply(1, 2)]);
    passed.extend([drive(1, 60), reply(1, 3), drive(1, 60), reply(1, 4)]);
    for (n, passed) in (0..).zip(passed) {
        log.add_event(&at(n, passed));
    }
    log.add_message(millis(20), false, "enough");
    let page = newest(&log);
    let collapsed: Vec<_> = page.rows.iter().map(|row| row.collapsed_before).collect();
    assert_eq!(collapsed, [0, 0, 4, 0, 2]);
    assert_eq!((page.collapsed, page.kept), (6, 11));
    log.filter(&Filter::default());
    let page = newest(&log);
    assert_eq!((page.rows.len(), page.collapsed), (11, 0));
}

#[test]
fn thousands_that_are_collapsed_are_counted_before_their_row() {
    let mut log = log(10_000);
    log.filter(&collapsed());
    log.add_message(millis(0), false, "begin");
    for n in 1..=5_000 {
        log.add_event(&at(n, query(1)));
    }
    log.add_message(millis(5_001), false, "end");
    for first in [None, Some(0), Some(1)] {
        let page = log.page(Window { first, rows: 2 });
        let end = page.rows.last().unwrap();
        assert_eq!((end.number, end.collapsed_before), (1, 5_000), "{first:?}");
    }
}

#[test]
fn what_is_collapsed_gives_way_too() {
    let mut log = log(100);
    log.filter(&collapsed());
    log.add_message(millis(0), false, "begin");
    for n in 1..=300 {
        log.add_event(&at(n, query(1)));
    }
    log.add_message(millis(301), false, "end");
    let page = newest(&log);
    assert_eq!(meanings(&page.rows), ["end"]);
    assert_eq!((page.collapsed, page.rows[0].collapsed_before), (99, 99));
    assert_eq!(page.gone, 202);
}

#[test]
fn clearing_forgets_everything_and_shows_the_present_again() {
    let mut log = log(10);
    log.filter(&collapsed());
    for n in 0..30 {
        log.add_event(&at(n, drive(1, 50)));
        log.add_event(&at(n, reply(1, 0)));
    }
    assert!(newest(&log).rows.is_empty());
    log.clear();
    let page = newest(&log);
    assert_eq!((page.kept, page.gone, page.collapsed), (0, 0, 0));
    assert_eq!(
        (page.oldest, page.end, page.filtered_per_mille),
        (0, 0, 1000)
    );
    log.add_event(&at(31, drive(1, 50)));
    log.add_event(&at(33, drive(1, 50)));
    assert_eq!(meanings(&newest(&log).rows), ["drive +50 rpm"]);
}

#[test]
fn the_newest_rows_are_there_before_a_filter_is_through() {
    let mut log = log(10_000);
    for n in 0..10_000 {
        log.add_event(&driven(n));
    }
    log.filter(&of_kind(Kind::Tx));
    let at_once = newest(&log);
    assert!(!log.is_filtered());
    assert_eq!(at_once.filtered_per_mille, 25, "256 of 10,000");
    assert_eq!(at_once.rows.len(), 128);
    log.advance(4_744);
    let half = newest(&log);
    assert_eq!(half.filtered_per_mille, 500);
    assert_eq!(half.end, at_once.end);
    assert_eq!(
        half.rows[400 - 128..],
        at_once.rows,
        "rows keep their numbers meanwhile"
    );
    finish(&mut log);
    let through = newest(&log);
    assert_eq!(
        (through.end - through.oldest, through.filtered_per_mille),
        (5_000, 1000)
    );
}

#[test]
fn a_frame_sent_by_hand_is_shown_whatever_is_collapsed_or_filtered() {
    let mut log = log(100);
    log.filter(&collapsed());
    let [first, again] = by_hand(Request::Query { id: id(1) });
    let passed = [
        query(1),
        reply(1, 1),
        first,
        reply(1, 2),
        again,
        reply(1, 3),
    ];
    for (n, passed) in (0..).zip(passed) {
        log.add_event(&at(n, passed));
    }
    let shown = |log: &Log| -> Vec<String> {
        let rows = newest(log).rows;
        rows.iter().map(|row| row.time[9..].to_owned()).collect()
    };
    // The first reply is no routine, and neither are those to the frames sent by hand.
    assert_eq!(shown(&log), ["963", "964", "965", "966", "967"]);
    for filter in [of_kind(Kind::Error), text("no such text")] {
        log.filter(&filter);
        assert_eq!(shown(&log), ["964"], "its repetitions are filtered");
    }
}

#[test]
fn a_frame_of_the_bus_shows_that_one_by_hand_drove_between() {
    let mut log = log(100);
    log.filter(&collapsed());
    let setpoint = Setpoint::velocity(SpeedTarget::new(50).unwrap());
    let [by_hand, _] = by_hand(Request::drive(id(1), setpoint));
    for (n, passed) in (0..).zip([drive(1, 50), drive(1, 50), by_hand, drive(1, 50)]) {
        log.add_event(&at(n, passed));
    }
    let collapsed: Vec<_> = newest(&log)
        .rows
        .iter()
        .map(|row| row.collapsed_before)
        .collect();
    assert_eq!(collapsed, [0, 1, 0]);
}

#[test]
fn opened_rows_stay_open_while_the_oldest_give_way() {
    let mut log = log(20);
    log.filter(&collapsed());
    log.add_message(millis(0), false, "begin");
    for n in 1..=10 {
        log.add_event(&at(n, query(1)));
    }
    log.add_message(millis(11), false, "end");
    log.toggle(1);
    let page = newest(&log);
    assert_eq!((page.rows.len(), page.collapsed), (12, 0));
    assert_eq!((page.rows[1].opened, page.rows[11].opened), (10, 0));
    for n in 12..25 {
        log.add_event(&at(n, query(2)));
    }
    let page = newest(&log);
    assert_eq!((page.oldest, page.rows[0].opened), (5, 6));
    assert_eq!((page.rows.len(), page.collapsed), (7, 13));
    log.toggle(5);
    let page = newest(&log);
    assert_eq!(meanings(&page.rows), ["end"]);
    assert_eq!((page.collapsed, page.rows[0].collapsed_before), (19, 6));
    log.toggle(7);
    log.toggle(99);
    assert_eq!(newest(&log), page, "there is no such row");
}
