use motorlink_protocol::{Current, Frame, Layout, Rpm};
use proptest::prelude::*;

use super::*;
use crate::record::Event;

fn reply(at_us: u64, id: u8, rpm: i16) -> Record {
    let (frame, asked) = (reply_frame(id, rpm), Some(Layout::Query));
    record(at_us, What::Line(LineEventKind::Received { frame, asked }))
}

fn reply_frame(id: u8, rpm: i16) -> Frame {
    let [high, low] = rpm.to_be_bytes();
    Frame::with_crc([id, 2, 0, 9, high, low, 30, 0, 0])
}

fn record(at_us: u64, what: What) -> Record {
    Record {
        at: Instant::from_micros(at_us),
        utc_ns: at_us.saturating_mul(1_000),
        what,
    }
}

fn overview(records: &[Record]) -> Overview {
    let mut overview = Overview::default();
    for record in records {
        overview.add(record);
    }
    overview
}

#[test]
fn an_hour_has_no_more_buckets_than_a_minute() {
    let hour: Vec<Record> = (0..3_600).map(|n| reply(n * 1_000_000, 1, 5)).collect();
    let overview = overview(&hour);
    let (_, motor) = overview.motors().next().unwrap();
    assert!(motor.buckets().len() <= BUCKETS_MAX);
    assert!(motor.buckets().len() > BUCKETS_MAX / 2);
    assert_eq!(motor.replies, 3_600);
    assert_eq!(overview.duration(), Duration::from_secs(3_599));
}

#[test]
fn a_time_that_cannot_be_does_not_take_for_ever() {
    let overview = overview(&[reply(0, 1, 5), reply(u64::MAX, 1, 7), reply(3, 2, 1)]);
    assert_eq!(overview.motors().count(), 2);
    assert!(overview.bucket() > Duration::from_secs(1_000_000));
}

#[test]
fn events_are_marks_and_silence_is_counted() {
    let id = MotorId::new(7).unwrap();
    let waited_us = 8_000;
    let overview = overview(&[
        record(
            5,
            What::Event(Event::new(EventKind::Connected, "Connected")),
        ),
        record(9, What::Line(LineEventKind::Silence { id, waited_us })),
        record(
            12,
            What::Event(Event::new(EventKind::Limit, "Too fast").bad()),
        ),
    ]);
    let marks: Vec<_> = overview
        .marks()
        .iter()
        .map(|mark| (mark.after.as_micros(), mark.error))
        .collect();
    assert_eq!(marks, [(0, false), (7, true)]);
    assert_eq!(
        (overview.lost, overview.motors().next().unwrap().1.lost),
        (1, 1)
    );
}

/// A scan asks every address and reports no silence.
#[test]
fn an_address_that_was_only_scanned_is_no_motor() {
    let query = |id| Frame::with_crc([id, 0x74, 0, 0, 0, 0, 0, 0, 0]);
    let sent = |id| LineEventKind::Sent {
        frame: query(id),
        mode: None,
    };
    let mut records: Vec<_> = (1..=254)
        .map(|id| record(u64::from(id) * 1_000, What::Line(sent(id))))
        .collect();
    let silence = LineEventKind::Silence {
        id: MotorId::new(9).unwrap(),
        waited_us: 8_000,
    };
    records.push(record(300_000, What::Line(silence)));
    records.push(reply(301_000, 7, 50));
    let overview = overview(&records);
    let stored = Overview::from_json(overview.to_json().as_bytes()).unwrap();
    for overview in [overview, stored] {
        let ids: Vec<_> = overview.motors().map(|(id, _)| id.get()).collect();
        assert_eq!((ids, overview.sent), (vec![7, 9], 254));
    }
}

#[test]
fn marks_have_a_bound() {
    let event = |n| record(n, What::Event(Event::new(EventKind::Notice, "x")));
    let records: Vec<Record> = (0..MARKS_MAX as u64 + 3).map(event).collect();
    let overview = overview(&records);
    assert_eq!(
        (overview.marks().len(), overview.marks_left_out),
        (MARKS_MAX, 3)
    );
}

#[test]
fn bookmarks_are_kept_where_other_events_give_way() {
    let event = |n, kind| record(n, What::Event(Event::new(kind, "x")));
    let events = (0..MARKS_MAX as u64 + 3).map(|n| event(n, EventKind::Notice));
    let bookmarks = (0..BOOKMARKS_MAX as u64 + 2).map(|n| event(9_000 + n, EventKind::Bookmark));
    let overview = overview(&events.chain(bookmarks).collect::<Vec<_>>());
    assert_eq!(bookmarks_in(overview.marks()), BOOKMARKS_MAX);
    assert_eq!(overview.marks().len(), MARKS_MAX);
    assert_eq!(overview.marks_left_out, 3 + BOOKMARKS_MAX as u64 + 2);
    let stored = Overview::from_json(overview.to_json().as_bytes());
    assert_eq!(stored, Some(overview));
}

#[test]
fn replies_in_separate_frames_have_the_units_and_the_names_of_their_model() {
    let line = |at_us, kind| record(at_us, What::Line(kind));
    let received = |at_us, text: &str| {
        let (frame, asked) = (text.parse().unwrap(), None);
        line(at_us, LineEventKind::Received { frame, asked })
    };
    for (model, offset, current) in [(Model::Ddsm210, 0, None), (Model::Ddsm400, 1, Some(4))] {
        let frame = |bytes: [u8; 9]| Frame::with_crc(bytes).to_string();
        let records = [
            line(0, LineEventKind::ModelSelected(model)),
            received(1, &frame([1, 0x75 + offset, 2, 0, 0, 0, 0, 0, 0])),
            // 50 rpm, a current of 8, fault bit 1.
            received(2, &frame([1, 0x64 + offset, 1, 0xF4, 0, 8, 0, 31, 2])),
            received(3, &frame([1, 0x74 + offset, 0, 0, 0, 7, 0, 0, 0])),
        ];
        let overview = overview(&records);
        let stored = Overview::from_json(overview.to_json().as_bytes()).unwrap();
        for overview in [overview, stored] {
            let (_, motor) = overview.motors().next().unwrap();
            let extent = motor.extent().unwrap();
            assert_eq!(motor.replies, 3);
            assert_eq!(extent.speed, (Rpm::new(50), Rpm::new(50)), "{model}");
            let current = current.map(Current::from_raw);
            assert_eq!(extent.current, current.map(|one| (one, one)), "{model}");
            assert_eq!(motor.temperature_max_c, Some(31));
            assert_eq!(motor.faults.to_string(), "overcurrent", "{model}");
        }
    }
}

#[test]
fn replies_alone_have_a_time() {
    let (frame, asked) = (reply_frame(1, 5), Some(Layout::Query));
    let reply = |at_us| record(at_us, What::Line(LineEventKind::Received { frame, asked }));
    let overview = overview(&[reply(3_000_000), reply(5_000_000)]);
    let stored = Overview::from_json(overview.to_json().as_bytes()).unwrap();
    assert_eq!(stored.duration(), Duration::from_secs(2));
    assert_eq!(stored.span_ns(), Some((3_000_000_000, 5_000_000_000)));
}

proptest! {
    #[test]
    fn no_extreme_is_lost_and_what_is_stored_is_read(
        replies in prop::collection::vec((0..10_000_000_u64, 1..4_u8, any::<i16>()), 1..300)
    ) {
        let records: Vec<Record> = replies.iter().map(|(at, id, rpm)| reply(*at, *id, *rpm)).collect();
        let overview = overview(&records);
        for (id, motor) in overview.motors() {
            let speeds = replies.iter().filter(|one| one.1 == id.get()).map(|one| one.2);
            let extremes = (speeds.clone().min().map(Rpm::new), speeds.max().map(Rpm::new));
            let extent = motor.extent().unwrap();
            prop_assert_eq!((Some(extent.speed.0), Some(extent.speed.1)), extremes);
            prop_assert_eq!(extent.current, Some((Current::from_raw(9), Current::from_raw(9))));
            prop_assert_eq!(motor.temperature_max_c, Some(30));
        }
        prop_assert_eq!(Overview::from_json(overview.to_json().as_bytes()), Some(overview));
    }
}

#[test]
fn what_is_no_overview_is_none() {
    let json = Overview::default().to_json();
    assert_eq!(
        Overview::from_json(json.as_bytes()),
        Some(Overview::default())
    );
    for other in [
        "",
        "{}",
        "[]",
        &json.replace("\"version\":1", "\"version\":2"),
    ] {
        assert_eq!(Overview::from_json(other.as_bytes()), None);
    }
    let zero = json.replace("\"bucket_us\":1000", "\"bucket_us\":0");
    assert_eq!(Overview::from_json(zero.as_bytes()), None);
}
