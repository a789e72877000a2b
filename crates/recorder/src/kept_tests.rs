use std::time::Duration;

use motorlink_messages::{
    recorder::ToRecorder,
    sessions::{Kept, NotSaved},
};
use motorlink_protocol::Layout;

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
    kept_of(recorder, None, most)
}

/// The same, of so much of its end.
fn kept_of(recorder: &mut Recorder, last: Option<Duration>, most: u64) -> Vec<KeptRecord> {
    let mut all = Vec::new();
    let mut next = recorder.first_kept(last, most);
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
            kept_of(&mut recorder, Some(last), 3),
            all[end..],
            "{millis}"
        );
    }
    assert_eq!(kept_of(&mut recorder, Some(Duration::MAX), 3), all);
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
    let Kept::Part { records, .. } = recorder.first_kept(None, 1) else {
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
fn a_reply_whose_entry_is_dropped_meanwhile_is_kept_as_a_reading() {
    let reply = |millis| KeptRecord::Line(received(millis));
    for read_before in 0..6 {
        let mut recorder = recorder(4);
        recorder.handle(ToRecorder::Record(true));
        (1..=6).for_each(|millis| recorder.add_event(&received(millis)));
        let Kept::Part { mut records, .. } = recorder.first_kept(None, read_before) else {
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
            assert!(
                [reading(millis), reply(millis)].contains(record),
                "{read_before}: {records:?}"
            );
        }
        assert_eq!(records[4..], [reply(5), reply(6)]);
    }
}

#[test]
fn samples_from_before_the_log_have_the_model_of_its_oldest_entry() {
    let begins = |millis| {
        KeptRecord::Line(LineEvent {
            at: at(millis),
            kind: LineEventKind::ModelSelected(Model::Ddsm315),
        })
    };
    let LineEvent { kind, .. } = received(0);
    let mut recorder = recorder(2);
    recorder.handle(ToRecorder::Record(true));
    let KeptRecord::Line(selected) = begins(0) else {
        panic!("an event")
    };
    recorder.add_event(&selected);
    (1..=4).for_each(|millis| {
        recorder.add_event(&LineEvent {
            at: at(millis),
            kind,
        });
    });
    let entries = [3, 4].map(|millis| KeptRecord::Line(received(millis)));
    let expected = [vec![begins(1), reading(1), reading(2)], entries.to_vec()].concat();
    assert_eq!(kept(&mut recorder, 1), expected);
    recorder.handle(ToRecorder::Clear);
    let readings: Vec<_> = kept(&mut recorder, 1);
    assert_eq!(readings[..3], expected[..3]);
    assert_eq!(readings.len(), 5);
}

#[test]
fn a_log_that_was_cleared_or_restored_meanwhile_is_said() {
    let mut recorder = recorder(100);
    for millis in 0..5 {
        recorder.add_event(&sent(millis, QUERY));
    }
    for message in [ToRecorder::Clear, ToRecorder::EndClear { undo: true }] {
        recorder.first_kept(None, 1);
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
