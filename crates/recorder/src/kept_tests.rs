use std::time::Duration;

use motorlink_messages::{
    Adapter, Connection, ToPage, Update, encode,
    recorder::ToRecorder,
    sessions::{Kept, NotSaved},
};
use motorlink_protocol::{Frame, Layout, Mode, MotorId, family::Model};

use super::*;
use crate::{recorder::Recorder, saved::Summary, wall_clock::WallClock};

const QUERY: &str = "01 74 00 00 00 00 00 00 00 04";
const DRIVE: &str = "01 64 00 64 00 00 00 00 00 4F";
const REPLY: &str = "01 02 02 CD 00 64 17 CF 00 8F";

fn at(millis: u64) -> Instant {
    Instant::from_millis(millis)
}

fn sent(millis: u64, frame: &str) -> LineEvent {
    let frame = frame.parse().unwrap();
    let mode = (frame == DRIVE.parse().unwrap()).then_some(Mode::Velocity);
    LineEvent {
        at: at(millis),
        kind: LineEventKind::Sent { frame, mode },
    }
}

fn received(millis: u64) -> LineEvent {
    let (frame, asked) = (REPLY.parse().unwrap(), Some(Layout::Drive));
    LineEvent {
        at: at(millis),
        kind: LineEventKind::Received { frame, asked },
    }
}

fn recorder(log: u64) -> Recorder {
    Recorder::with(
        WallClock::new(0.0, 0),
        Log::with_capacity(log),
        Recording::default(),
    )
}

/// Everything that is kept, in parts of this number.
fn kept(recorder: &mut Recorder, most: u64) -> Vec<KeptRecord> {
    kept_of(recorder, SaveRange::Line, most)
}

/// The same, of this range.
fn kept_of(recorder: &mut Recorder, range: SaveRange, most: u64) -> Vec<KeptRecord> {
    let mut all = Vec::new();
    let mut next = recorder.first_kept(range, most);
    loop {
        let Kept::Part {
            records,
            is_last,
            progress,
            ..
        } = next
        else {
            panic!("the log has changed")
        };
        all.extend(records);
        assert!(progress.done <= progress.of);
        if is_last {
            assert_eq!(progress.done, progress.of);
            break;
        }
        next = recorder.next_kept(most);
    }
    all
}

#[test]
fn every_entry_is_kept_as_it_was_and_no_sample_twice() {
    let mut recorder = recorder(1_000);
    recorder.handle(ToRecorder::Record(true));
    let events = [sent(1, QUERY), received(2), sent(3, DRIVE), received(4)];
    for event in &events {
        recorder.add_event(event);
    }
    recorder.handle(ToRecorder::AddMessage {
        at: at(5),
        error: true,
        text: "Adapter unplugged".to_owned(),
    });
    let mut expected: Vec<_> = events.into_iter().map(KeptRecord::Line).collect();
    expected.push(KeptRecord::Message {
        at: at(5),
        error: true,
        text: "Adapter unplugged".to_owned(),
    });
    for most in [1, 2, 3, 100] {
        assert_eq!(kept(&mut recorder, most), expected);
    }
}

#[test]
fn the_last_minutes_are_the_end_of_everything() {
    let mut recorder = recorder(2);
    recorder.handle(ToRecorder::Record(true));
    for millis in 1..=10 {
        recorder.add_event(&received(millis));
    }
    // Of the last two there are entries, of the others only samples. No loop was asked for.
    let all = kept(&mut recorder, 100);
    assert_eq!(all.len(), 10);
    for millis in 0..=12 {
        let last = Duration::from_millis(millis);
        let end = all
            .len()
            .saturating_sub(1 + usize::try_from(millis).unwrap());
        assert_eq!(
            kept_of(&mut recorder, SaveRange::Last(last), 3),
            all[end..],
            "{millis}"
        );
    }
    assert_eq!(
        kept_of(&mut recorder, SaveRange::Last(Duration::MAX), 3),
        all
    );
}

#[test]
fn samples_from_before_the_log_come_first() {
    let mut recorder = recorder(2);
    recorder.handle(ToRecorder::Record(true));
    for event in [
        sent(1, DRIVE),
        received(2),
        received(2),
        sent(3, QUERY),
        received(4),
    ] {
        recorder.add_event(&event);
    }
    let known = LineEvent {
        at: at(2),
        kind: LineEventKind::Known {
            id: MotorId::FIRST,
            mode: Mode::Velocity,
            value: Some([0, 0x64]),
        },
    };
    let expected = [known, received(2), received(2), sent(3, QUERY), received(4)];
    assert_eq!(kept(&mut recorder, 2), expected.map(KeptRecord::Line));
}

#[test]
fn separate_frames_from_before_the_log_come_with_their_model_and_their_loop() {
    let of = |millis, bytes| LineEvent {
        at: at(millis),
        kind: LineEventKind::Received {
            frame: Frame::with_crc(bytes),
            asked: None,
        },
    };
    let begins = |millis| LineEvent {
        at: at(millis),
        kind: LineEventKind::ModelSelected(Model::Ddsm400),
    };
    let drive = |millis| LineEvent {
        at: at(millis),
        kind: LineEventKind::Sent {
            frame: Frame::with_crc([1, 0x64, 1, 0xF4, 0, 0, 0, 0, 0]),
            mode: Some(Mode::OpenLoop),
        },
    };
    let odometry = |millis| of(millis, [1, 0x75, 0, 0, 0, 7, 0x40, 0, 0]);
    let driven = |millis| of(millis, [1, 0x65, 1, 0xF4, 0, 8, 0, 31, 0]);
    let names_loop = of(1, [1, 0x76, 0, 0, 0, 0, 0, 0, 0]);
    let known = |millis, value| LineEvent {
        at: at(millis),
        kind: LineEventKind::Known {
            id: MotorId::FIRST,
            mode: Mode::OpenLoop,
            value,
        },
    };
    let mut recorder = recorder(2);
    recorder.handle(ToRecorder::Record(true));
    let events = [begins(0), names_loop, odometry(2), drive(3), driven(4)];
    let more = [driven(900), driven(1_100), drive(1_200), driven(1_300)];
    for event in events.into_iter().chain(more) {
        recorder.add_event(&event);
    }
    let value = Some([1, 0xF4]);
    let expected = [
        begins(2),
        known(2, None),
        odometry(2),
        known(4, value),
        driven(4),
        driven(900),
        // For a reader that begins here.
        known(1_100, value),
        driven(1_100),
        drive(1_200),
        driven(1_300),
    ];
    let records = kept(&mut recorder, 1);
    assert_eq!(records, expected.map(KeptRecord::Line));
}

#[test]
fn what_is_added_meanwhile_is_not_kept_and_what_is_dropped_is_skipped() {
    let mut recorder = recorder(3);
    for millis in 0..3 {
        recorder.add_event(&sent(millis, QUERY));
    }
    let Kept::Part { records, .. } = recorder.first_kept(SaveRange::Line, 1) else {
        panic!("a part")
    };
    assert_eq!(records.last(), Some(&KeptRecord::Line(sent(0, QUERY))));
    recorder.add_event(&sent(10, QUERY));
    recorder.add_event(&sent(11, QUERY));
    let Kept::Part {
        records, is_last, ..
    } = recorder.next_kept(100)
    else {
        panic!("a part")
    };
    assert_eq!(records, [KeptRecord::Line(sent(2, QUERY))]);
    assert!(is_last);
}

#[test]
fn a_reply_whose_entry_is_dropped_meanwhile_is_kept_from_the_recording() {
    let reply = |millis| KeptRecord::Line(received(millis));
    for read_before in 0..6 {
        let mut recorder = recorder(4);
        recorder.handle(ToRecorder::Record(true));
        (1..=6).for_each(|millis| recorder.add_event(&received(millis)));
        let Kept::Part { mut records, .. } = recorder.first_kept(SaveRange::Line, read_before)
        else {
            panic!("a part")
        };
        (7..=8).for_each(|millis| recorder.add_event(&received(millis)));
        let Kept::Part { records: rest, .. } = recorder.next_kept(100) else {
            panic!("a part")
        };
        records.extend(rest);
        assert_eq!(records.len(), 6, "{read_before}: {records:?}");
        // The log began at 3 and begins at 5 now.
        for (record, millis) in records.iter().zip(1..) {
            assert_eq!(*record, reply(millis), "{read_before}: {records:?}");
        }
        assert_eq!(records[4..], [reply(5), reply(6)]);
    }
}

#[test]
fn samples_from_before_the_log_have_their_model() {
    let begins = |millis| LineEvent {
        at: at(millis),
        kind: LineEventKind::ModelSelected(Model::Ddsm315),
    };
    let mut recorder = recorder(2);
    recorder.handle(ToRecorder::Record(true));
    recorder.add_event(&begins(0));
    (1..=4).for_each(|millis| recorder.add_event(&received(millis)));
    let replies = (1..=4).map(received);
    let expected: Vec<_> = [begins(1)].into_iter().chain(replies).collect();
    let expected: Vec<_> = expected.into_iter().map(KeptRecord::Line).collect();
    assert_eq!(kept(&mut recorder, 1), expected);
    recorder.handle(ToRecorder::Clear);
    assert_eq!(kept(&mut recorder, 1), expected);
}

#[test]
fn a_log_that_was_cleared_or_restored_meanwhile_is_said() {
    let mut recorder = recorder(100);
    for millis in 0..5 {
        recorder.add_event(&sent(millis, QUERY));
    }
    for message in [ToRecorder::Clear, ToRecorder::EndClear { undo: true }] {
        recorder.first_kept(SaveRange::Line, 1);
        recorder.handle(message);
        assert_eq!(recorder.next_kept(1), Kept::Changed);
    }
    assert_eq!(kept(&mut recorder, 2).len(), 5);
}

#[test]
fn why_nothing_can_be_saved_is_known_before_a_file_is_chosen() {
    let mut recorder = recorder(2);
    assert_eq!(recorder.not_kept(), Some(NotSaved::Nothing));
    recorder.add_event(&received(1));
    assert_eq!(recorder.not_kept(), None);
    recorder.handle(ToRecorder::Clear);
    // The samples of the last ten minutes.
    assert_eq!(recorder.not_kept(), None);
    recorder.restore(&Summary::default(), &[]);
    assert_eq!(recorder.not_kept(), Some(NotSaved::Restoring));
}

fn shows(recorder: &mut Recorder, millis: u64, connection: Connection) {
    let update = Update::without_motors(at(millis), connection);
    recorder.add_state(encode(&ToPage::Update(update)).unwrap());
}

/// When the entries, samples and states of this range were.
fn times(recorder: &mut Recorder, range: SaveRange) -> Vec<Instant> {
    let records = kept_of(recorder, range, 3);
    let times = records.into_iter().map(|record| match record {
        KeptRecord::Line(event) => event.at,
        KeptRecord::Message { at, .. } | KeptRecord::State { at, .. } => at,
    });
    times.collect()
}

#[test]
fn what_two_lines_have_carried_is_never_in_one_range() {
    let mut recorder = recorder(1_000);
    let real = Connection::Connected(Adapter::Serial(None));
    recorder.add_event(&sent(5, QUERY));
    shows(&mut recorder, 10, Connection::Connected(Adapter::VIRTUAL));
    recorder.add_event(&received(20));
    shows(&mut recorder, 30, Connection::Disconnected);
    assert_eq!(
        times(&mut recorder, SaveRange::Line),
        [5, 10, 20, 30].map(at)
    );
    assert!(times(&mut recorder, SaveRange::LineBefore).is_empty());

    // The frames that tell which adapter has the motors.
    shows(&mut recorder, 40, Connection::Connecting);
    recorder.add_event(&sent(45, QUERY));
    shows(&mut recorder, 50, real);
    recorder.add_event(&received(60));
    // It is plugged out and in again, then closed and opened.
    shows(
        &mut recorder,
        70,
        Connection::Reconnecting(Adapter::Serial(None)),
    );
    shows(&mut recorder, 80, real);
    shows(&mut recorder, 90, Connection::Disconnected);
    shows(&mut recorder, 100, real);
    recorder.add_event(&received(110));
    let line = [30, 40, 45, 50, 60, 70, 80, 90, 100, 110].map(at);
    assert_eq!(times(&mut recorder, SaveRange::Line), line);
    assert_eq!(
        times(&mut recorder, SaveRange::Last(Duration::from_secs(9))),
        line
    );
    assert_eq!(
        times(&mut recorder, SaveRange::LineBefore),
        [5, 10, 20].map(at)
    );

    // The recording stays, and still has both.
    recorder.handle(ToRecorder::Clear);
    shows(&mut recorder, 120, real);
    assert_eq!(times(&mut recorder, SaveRange::LineBefore), [20].map(at));
    assert_eq!(
        times(&mut recorder, SaveRange::Line),
        [60, 110, 120].map(at)
    );
}

#[test]
fn the_recording_is_from_its_first_to_its_last_sample_of_one_line() {
    let mut recorder = recorder(1_000);
    let real = Connection::Connected(Adapter::Serial(None));
    assert!(times(&mut recorder, SaveRange::Recording).is_empty());
    shows(&mut recorder, 10, Connection::Connected(Adapter::VIRTUAL));
    recorder.add_event(&received(20));
    assert!(times(&mut recorder, SaveRange::Recording).is_empty());
    recorder.handle(ToRecorder::Record(true));
    recorder.add_event(&received(30));
    recorder.add_event(&sent(35, QUERY));
    recorder.add_event(&received(40));
    recorder.handle(ToRecorder::Record(false));
    recorder.add_event(&received(50));
    let samples = [30, 35, 40].map(at);
    assert_eq!(times(&mut recorder, SaveRange::Recording), samples);

    // Another line alone does not change it.
    shows(&mut recorder, 60, real);
    recorder.add_event(&received(70));
    assert_eq!(times(&mut recorder, SaveRange::Recording), samples);
    recorder.handle(ToRecorder::Record(true));
    recorder.add_event(&received(80));
    recorder.handle(ToRecorder::Record(false));
    assert_eq!(times(&mut recorder, SaveRange::Recording), [80].map(at));
}
