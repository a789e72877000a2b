//! Which entries the log has, which it drops, and their order.

use motorlink_messages::recorder::{Kind, Row, Window};
use motorlink_protocol::Instant;
use motorlink_recorder::{ENTRIES_MAX, Log};

use crate::line::{at, drive, driven, junk, log, newest, query, silence};

fn millis(at: u64) -> Instant {
    Instant::from_millis(at)
}

#[test]
fn a_row_says_when_who_what_and_what_it_means() {
    let mut log = log(10);
    log.add_event(&at(0, drive(1, -100)));
    log.add_event(&at(8, silence(1)));
    log.add_event(&at(61_000, junk(&[1, 2, 3])));
    log.add_message(millis(61_001), false, "connected");
    log.add_message(millis(61_002), true, "the adapter was pulled out");
    let page = newest(&log);
    let row = |number, kind, time: &str, id: &str, hex: &str, meaning: &str| Row {
        number,
        kind,
        time: time.into(),
        id: id.into(),
        hex: hex.into(),
        meaning: meaning.into(),
        collapsed_before: 0,
        opened: 0,
    };
    let frame = "01 64 FF 9C 00 00 00 00 00 9A";
    assert_eq!(
        page.rows,
        [
            row(0, Kind::Tx, "13:15:36.962", "0x01", frame, "drive −100 rpm"),
            row(
                1,
                Kind::Error,
                "13:15:36.970",
                "0x01",
                "",
                "no reply within 8.0 ms"
            ),
            row(
                2,
                Kind::Error,
                "13:16:37.962",
                "",
                "01 02 03",
                "3 bytes, no valid frame"
            ),
            row(3, Kind::System, "13:16:37.963", "", "", "connected"),
            row(
                4,
                Kind::Error,
                "13:16:37.964",
                "",
                "",
                "the adapter was pulled out"
            ),
        ]
    );
    assert_eq!((page.oldest, page.end, page.kept, page.gone), (0, 5, 5, 0));
    assert_eq!(page.filtered_per_mille, 1000);
}

#[test]
fn the_newest_million_is_kept_and_what_went_is_counted() {
    let mut log = Log::default();
    for n in 0..ENTRIES_MAX + 2_345 {
        log.add_event(&driven(n));
    }
    let page = newest(&log);
    assert_eq!((page.kept, page.gone), (1_000_000, 2_345));
    assert_eq!((page.oldest, page.end), (2_345, 1_002_345));
    assert_eq!(page.rows.len(), 400);
    assert_eq!(page.rows[0].number, 1_001_945);
}

#[test]
fn memory_does_not_grow_once_the_log_is_full() {
    let capacity = 20_000;
    let mut log = log(capacity);
    for n in 0..capacity {
        log.add_event(&driven(n));
    }
    let most = 22 * 1024;
    assert!(log.reserved() <= most);
    for n in capacity..3 * capacity {
        log.add_event(&driven(n));
        if n % 100 == 0 {
            log.add_message(millis(n), false, "a line");
        }
        assert!(log.reserved() <= most, "{} places", log.reserved());
    }
    assert_eq!(newest(&log).kept, capacity);
}

#[test]
fn rows_keep_their_numbers_while_old_ones_give_way() {
    let mut log = log(50);
    for n in 0..50 {
        log.add_event(&driven(n));
    }
    let window = |first| Window {
        first: Some(first),
        rows: 5,
    };
    let before = log.page(window(30)).rows;
    assert_eq!(before[0].number, 30);
    for n in 50..70 {
        log.add_event(&driven(n));
    }
    let page = log.page(window(30));
    assert_eq!(page.rows, before);
    assert_eq!((page.oldest, page.end), (20, 70));
    let partly: Vec<_> = log
        .page(window(17))
        .rows
        .iter()
        .map(|row| row.number)
        .collect();
    assert_eq!(partly, [20, 21], "17 to 19 are gone");
    assert!(log.page(window(10)).rows.is_empty());
    assert!(log.page(window(70)).rows.is_empty(), "there is none yet");
}

#[test]
fn a_window_has_no_more_rows_than_a_page_may_ask_for() {
    let mut log = log(2_000);
    for n in 0..2_000 {
        log.add_event(&driven(n));
    }
    let rows = u16::MAX;
    assert_eq!(log.page(Window { first: None, rows }).rows.len(), 400);
    assert_eq!(
        log.page(Window {
            first: Some(7),
            rows
        })
        .rows
        .len(),
        400
    );
    assert!(
        log.page(Window {
            first: Some(7),
            rows: 0
        })
        .rows
        .is_empty()
    );
}

#[test]
fn what_the_page_says_stands_where_its_time_belongs() {
    let mut log = log(100);
    for n in [10, 20, 30, 40] {
        log.add_event(&at(n, query(1)));
    }
    log.add_message(millis(25), false, "late");
    log.add_message(millis(50), false, "early");
    for n in [45, 48, 55] {
        log.add_event(&at(n, query(2)));
    }
    log.add_message(millis(48), false, "as the frame");
    let page = newest(&log);
    let times: Vec<_> = page.rows.iter().map(|row| &row.time[6..]).collect();
    let expected = [
        "36.972", "36.982", "36.987", "36.992", "37.002", "37.007", "37.010", "37.010", "37.012",
        "37.017",
    ];
    assert_eq!(times, expected);
    assert_eq!(page.rows[2].meaning, "late");
    assert_eq!(
        page.rows[7].meaning, "as the frame",
        "behind what came before it"
    );
    assert_eq!(page.rows[8].meaning, "early");
}

#[test]
fn a_line_much_too_late_is_put_among_the_newest_only() {
    let mut log = log(10_000);
    for n in 1_000..3_000 {
        log.add_event(&at(n, query(1)));
    }
    log.add_message(millis(0), false, "from long ago");
    let rows = newest(&log).rows;
    let place = rows.iter().position(|row| row.kind == Kind::System);
    assert_eq!(place, Some(400 - 257));
}

#[test]
fn the_texts_of_a_log_full_of_them_are_bounded() {
    let mut log = log(1_000_000);
    let line = "x".repeat(2_000);
    for n in 0..40_000 {
        log.add_message(millis(n), false, &line);
    }
    let page = newest(&log);
    assert!(
        page.kept <= 16_001 && page.gone == 40_000 - page.kept,
        "{} kept",
        page.kept
    );
}
