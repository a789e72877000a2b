use motorlink_protocol::MotorId;

use super::*;

const ALWAYS: Range<Instant> = Instant::ZERO..Instant::from_micros(u64::MAX);

fn reply_at(at: Instant) -> LineEvent {
    LineEvent {
        at,
        kind: LineEventKind::Received {
            frame: "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap(),
            asked: Some(Layout::Drive),
        },
    }
}

fn receive(recording: &mut Recording, millis: impl IntoIterator<Item = u64>) {
    for at in millis {
        recording.add_event(&reply_at(Instant::from_millis(at)));
    }
}

#[test]
fn samples_older_than_ten_minutes_are_dropped() {
    let mut recording = Recording::default();
    receive(&mut recording, [0, 1, 599_999, 600_000]);
    assert_eq!(recording.status().rolling, 4);
    receive(&mut recording, [600_001]);
    assert_eq!(recording.status().rolling, 4, "the one at 0 is too old");
    receive(&mut recording, [1_200_001]);
    assert_eq!(recording.status().rolling, 2);
}

#[test]
fn no_more_samples_are_kept_than_the_line_carries_in_ten_minutes() {
    let mut recording = Recording::default();
    receive(&mut recording, std::iter::repeat_n(5, 400_000));
    assert_eq!(recording.status().rolling, ROLLING_MAX);
    assert_eq!(ROLLING_MAX, 345_623);
    let reserved = recording.rolling.reserved();
    receive(&mut recording, std::iter::repeat_n(6, 400_000));
    assert!(recording.rolling.reserved() <= reserved + 1024);
}

#[test]
fn only_good_replies_are_samples() {
    let mut recording = Recording::default();
    let at = Instant::ZERO;
    let frame = "01 74 00 00 00 00 00 00 00 04".parse().unwrap();
    let silence = LineEventKind::Silence {
        id: MotorId::FIRST,
        waited_us: 1,
    };
    for passed in [
        LineEventKind::Sent { frame, mode: None },
        LineEventKind::Received { frame, asked: None },
        silence,
    ] {
        recording.add_event(&LineEvent { at, kind: passed });
    }
    assert_eq!(recording.status().rolling, 0);
}

#[test]
fn a_recording_goes_on_until_it_was_exported() {
    let mut recording = Recording::default();
    receive(&mut recording, [0, 10]);
    recording.record(true);
    receive(&mut recording, [20, 30, 45]);
    recording.record(false);
    receive(&mut recording, [1_000]);
    recording.record(true);
    receive(&mut recording, [5_000, 5_005]);
    let status = recording.status();
    assert_eq!(
        (status.recorded, status.recorded_ms, status.rolling),
        (5, 30, 8)
    );
    assert!(status.recording && !status.exported);

    let (which, range) = recording.to_export(&ALWAYS);
    assert_eq!(which, SampleSet::Recorded);
    recording.exported(range.end);
    assert!(recording.status().exported);
    receive(&mut recording, [5_010]);
    assert!(!recording.status().exported, "one more came");
    recording.record(false);
    recording.record(true);
    assert_eq!(
        recording.status().recorded,
        6,
        "it was not exported as it is"
    );

    let (_, range) = recording.to_export(&ALWAYS);
    recording.exported(range.end);
    recording.record(false);
    assert_eq!(recording.status().recorded, 6, "it is kept until the next");
    recording.record(true);
    receive(&mut recording, [6_000]);
    let status = recording.status();
    assert_eq!((status.recorded, status.recorded_ms), (1, 0));
}

#[test]
fn a_full_recording_ends_by_itself_and_keeps_what_it_has() {
    let mut recording = Recording::with_capacity(3);
    recording.record(true);
    receive(&mut recording, 0..10);
    let status = recording.status();
    assert!(status.full && !status.recording);
    assert_eq!((status.recorded, status.rolling), (3, 10));
    recording.record(true);
    receive(&mut recording, 10..12);
    assert_eq!(recording.status().recorded, 3, "it is exported first");
    let (_, range) = recording.to_export(&ALWAYS);
    recording.exported(range.end);
    recording.record(true);
    receive(&mut recording, 12..14);
    let status = recording.status();
    assert!(status.recording && !status.full);
    assert_eq!(status.recorded, 2);
}

#[test]
fn without_a_recording_the_last_ten_minutes_are_exported() {
    let mut recording = Recording::default();
    receive(&mut recording, 0..5);
    assert_eq!(recording.to_export(&ALWAYS), (SampleSet::Rolling, 0..5));
}
