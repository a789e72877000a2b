use motorlink_messages::{recorder::ToRecorder, sessions::Kept};
use motorlink_protocol::Layout;

use super::*;
use crate::{recorder::Recorder, wall_clock::WallClock};

const QUERY: &str = "01 74 00 00 00 00 00 00 00 04";
const DRIVE: &str = "01 64 00 64 00 00 00 00 00 4F";
const REPLY: &str = "01 02 02 CD 00 64 17 CF 00 8F";

fn at(millis: u64) -> Instant {
    Instant::from_millis(millis)
}

fn sent(millis: u64, frame: &str) -> LineEvent {
    let frame = frame.parse().unwrap();
    let mode = (frame == DRIVE.parse().unwrap()).then_some(motorlink_protocol::Mode::Velocity);
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

fn reading(millis: u64) -> KeptRecord {
    let LineEventKind::Received { frame, asked } = received(0).kind else {
        panic!("a reply")
    };
    KeptRecord::Line(LineEvent {
        at: at(millis),
        kind: LineEventKind::Reading { frame, asked },
    })
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
    let mut all = Vec::new();
    for part in 0.. {
        let Kept::Part {
            records,
            is_last,
            progress,
            ..
        } = recorder.kept(part == 0, most)
        else {
            panic!("the log has changed")
        };
        all.extend(records);
        assert!(progress.done <= progress.of);
        if is_last {
            assert_eq!(progress.done, progress.of);
            break;
        }
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
    let records = kept(&mut recorder, 2);
    let [KeptRecord::Line(command), first, second, query, reply] = &records[..] else {
        panic!("{records:?}")
    };
    let LineEventKind::Commanded { mode, .. } = command.kind else {
        panic!("{command:?}")
    };
    assert_eq!(mode, Some(motorlink_protocol::Mode::Velocity));
    assert_eq!([first, second], [&reading(2), &reading(2)]);
    assert_eq!(*query, KeptRecord::Line(sent(3, QUERY)));
    assert_eq!(*reply, KeptRecord::Line(received(4)));
}

#[test]
fn separate_frames_are_kept_with_their_readings_and_their_model() {
    let mut recorder = recorder(1_000);
    let KeptRecord::Line(reading) = reading(4) else {
        panic!("a reading")
    };
    let begins = LineEvent {
        at: at(1),
        kind: LineEventKind::ModelSelected(Model::Ddsm210),
    };
    for event in [begins, sent(3, QUERY), received(4), reading] {
        recorder.add_event(&event);
    }
    let begins = LineEvent {
        at: at(3),
        ..begins
    };
    let expected = [begins, sent(3, QUERY), received(4), reading];
    let records = kept(&mut recorder, 1);
    // The raw reply would be no sample of such a model; here it makes one more.
    assert_eq!(records[..3], expected.map(KeptRecord::Line)[..3]);
    assert!(records[3..].contains(&KeptRecord::Line(reading)));
}

#[test]
fn what_is_added_meanwhile_is_not_kept_and_what_is_dropped_is_skipped() {
    let mut recorder = recorder(3);
    for millis in 0..3 {
        recorder.add_event(&sent(millis, QUERY));
    }
    let Kept::Part { records, .. } = recorder.kept(true, 1) else {
        panic!("a part")
    };
    assert_eq!(records.last(), Some(&KeptRecord::Line(sent(0, QUERY))));
    recorder.add_event(&sent(10, QUERY));
    recorder.add_event(&sent(11, QUERY));
    let Kept::Part {
        records, is_last, ..
    } = recorder.kept(false, 100)
    else {
        panic!("a part")
    };
    assert_eq!(records, [KeptRecord::Line(sent(2, QUERY))]);
    assert!(is_last);
}

#[test]
fn a_log_that_was_cleared_ends_early_and_an_erased_one_is_said() {
    let mut recorder = recorder(100);
    for millis in 0..5 {
        recorder.add_event(&sent(millis, QUERY));
    }
    recorder.kept(true, 1);
    recorder.handle(ToRecorder::Clear);
    let Kept::Part { is_last, .. } = recorder.kept(false, 100) else {
        panic!("a part")
    };
    assert!(is_last);
    assert_eq!(recorder.kept(false, 1), Kept::Changed);
    recorder.kept(true, 0);
    recorder.handle(ToRecorder::EndClear { undo: true });
    assert_eq!(recorder.kept(false, 1), Kept::Changed);
    assert_eq!(kept(&mut recorder, 2).len(), 5);
}
