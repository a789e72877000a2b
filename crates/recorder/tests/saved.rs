//! A session that is saved, and restored into another recorder.

mod fixture;
mod properties;

use std::time::Duration;

use motorlink_bus::LineEventKind;
use motorlink_messages::{
    recorder::{Export, FromRecorder, RecordingStatus, ToRecorder},
    sessions::{Kept, KeptRecord, SaveRange},
    stored_state,
};
use motorlink_protocol::{Frame, Instant, Mode, family::Model};
use motorlink_recorder::{
    LocalTime, Output, Recorder, WallClock,
    saved::{PACKETS_BYTES_MAX, SEGMENT_BYTES_MAX, Segment, Stream},
};

use crate::line::{at, heard, reply};
use fixture::{Disk, EPOCH_MS, LATER_MS, Page, restored, summary};

#[test]
fn a_session_comes_back_as_it_was() {
    let mut page = Page::opened(EPOCH_MS);
    page.add_message(0, "Connected");
    page.drive(0..3_000);
    page.handle(ToRecorder::Record(true));
    page.pass(100);
    page.drive(3_000..9_000);
    page.handle(ToRecorder::Record(false));
    page.drive(9_000..10_000);
    let (log, telemetry) = (page.export(Export::Log), page.export(Export::Telemetry));
    let plot = page.export(Export::Plot);
    assert!(
        plot.lines()
            .skip(1)
            .all(|line| line.rsplit(',').skip(1).take(2).eq(["2", "50"])),
        "{plot}"
    );
    let status = page.recording();
    let disk = page.crash();

    let session = summary(&disk).session().unwrap();
    assert_eq!(session.packets, 10_000);
    assert_eq!(session.recorded, status.recorded);
    assert_eq!(session.recorded_ms, status.recorded_ms);
    assert!((session.from_ms - EPOCH_MS).abs() < 1.0);
    assert!((session.to_ms - EPOCH_MS - 9_999.0).abs() < 1.0);

    let mut page = restored(&disk, LATER_MS);
    assert!(page.told.contains(&FromRecorder::Restored));
    assert_eq!(page.export(Export::Log), log);
    assert_eq!(page.export(Export::Telemetry), telemetry);
    assert_eq!(page.export(Export::Plot), plot);
    let again = page.recording();
    assert!(!again.recording && again.exported);
    assert_eq!(again.rolling, status.rolling);
}

/// Separate frames do not name their loop, and the recorded ones have no requests.
#[test]
fn recorded_separate_frames_come_back_in_their_loop() {
    for (model, offset) in [(Model::Ddsm210, 0), (Model::Ddsm400, 1)] {
        let received = |bytes| heard(Frame::with_crc(bytes), None);
        let mut page = Page::opened(EPOCH_MS);
        let begins = LineEventKind::ModelSelected(model);
        page.recorder.add_event(&at(0, begins));
        page.handle(ToRecorder::Record(true));
        for (second, mode) in [Mode::OpenLoop, Mode::Position].into_iter().enumerate() {
            let began = second as u64 * 1_000;
            let named = received([1, 0x75 + offset, mode.byte(), 0, 0, 0, 0, 0, 0]);
            page.recorder.add_event(&at(began, named));
            for n in (began..began + 900).step_by(20) {
                let frame = Frame::with_crc([1, 0x64, 1, 0xF4, 0, 0, 0, 0, 0]);
                let mode = Some(mode);
                let sent = LineEventKind::Sent { frame, mode };
                page.recorder.add_event(&at(n, sent));
                let driven = received([1, 0x64 + offset, 1, 0xF4, 0, 8, 0, 31, 2]);
                page.recorder.add_event(&at(n + 2, driven));
                let [high, low] = u16::try_from(n).unwrap().to_be_bytes();
                let odometry = received([1, 0x74 + offset, 0, 0, 0, 7, high, low, 2]);
                page.recorder.add_event(&at(n + 10, odometry));
            }
            page.pass(300);
        }
        let telemetry = page.export(Export::Telemetry);
        let frame = Frame::with_crc([1, 0x64 + offset, 1, 0xF4, 0, 8, 0, 31, 2]);
        assert!(telemetry.contains(&format!(",31,,0x02,overcurrent,{frame}")));
        assert!(telemetry.contains(",1,Open loop,50,"), "{telemetry}");
        assert!(telemetry.contains(",1,Position,,"), "{telemetry}");
        let plot = page.export(Export::Plot);
        let mut page = restored(&page.crash(), LATER_MS);
        assert_eq!(page.export(Export::Telemetry), telemetry, "{model}");
        assert_eq!(page.export(Export::Plot), plot, "{model}");
    }
}

#[test]
fn this_session_goes_on_behind_the_restored_one_and_both_survive_the_next_crash() {
    let mut page = Page::opened(EPOCH_MS);
    page.handle(ToRecorder::Record(true));
    page.drive(0..2_000);
    let disk = page.crash();

    let mut page = Page::opened(LATER_MS);
    page.drive(0..500);
    page.pass(1_000);
    page.add_message(500, "before");
    page.restore(&disk);
    page.add_message(600, "behind");
    page.handle(ToRecorder::Record(true));
    page.drive(700..900);
    let log = page.export(Export::Log);
    let (before, behind) = (log.find("before").unwrap(), log.find("behind").unwrap());
    assert!(before < behind);
    assert_eq!(log.lines().count(), 1 + 2_000 + 500 + 1 + 1 + 200);
    assert!(
        log.contains("2026-11-21T13:45:00.499Z"),
        "by the wall clock"
    );
    let recorded = page.recording().recorded;
    let telemetry = page.export(Export::Telemetry);
    let disk = page.crash();

    let mut page = restored(&disk, LATER_MS + 600_000.0);
    assert_eq!(page.export(Export::Log), log);
    assert_eq!(page.recording().recorded, recorded);
    assert_eq!(page.export(Export::Telemetry), telemetry);
}

/// The times of the samples for the page on the clock of this session, in milliseconds.
fn past(page: &Page) -> Vec<Vec<i64>> {
    let parts = page.told.iter().filter_map(|told| match told {
        FromRecorder::Past { zero_us, samples } => {
            let at_us = |at: Instant| i64::try_from(at.as_micros()).unwrap() + zero_us;
            Some(
                samples
                    .iter()
                    .map(|sample| at_us(sample.at) / 1_000)
                    .collect(),
            )
        }
        _ => None,
    });
    parts.collect()
}

#[test]
fn the_page_is_given_the_restored_samples_at_their_times_in_bounded_parts() {
    let mut first = Page::opened(EPOCH_MS);
    for n in 0..4_500 {
        first.recorder.add_event(&at(n, reply(1, 7)));
    }
    first.run();
    let disk = first.crash();
    let mut page = Page::opened(EPOCH_MS + 60_000.0);
    page.recorder.add_event(&at(3, reply(1, 7)));
    page.restore(&disk);
    page.pass(300);
    let restored = page
        .told
        .iter()
        .position(|told| *told == FromRecorder::Restored);
    let given = page
        .told
        .iter()
        .position(|told| matches!(told, FromRecorder::Past { .. }));
    assert!(restored < given, "{restored:?} {given:?}");
    let parts = past(&page);
    let sizes: Vec<usize> = parts.iter().map(Vec::len).collect();
    assert_eq!(sizes, [2_000, 2_000, 500], "the newest first");
    let all: Vec<i64> = parts.into_iter().rev().flatten().collect();
    let expected: Vec<i64> = (0..4_500).map(|n| n - 60_000).collect();
    assert_eq!(all, expected, "before this session, each once");
}

#[test]
fn of_the_restored_samples_those_older_than_ten_minutes_stay_away() {
    let mut first = Page::opened(EPOCH_MS);
    first.drive(0..100);
    let disk = first.crash();
    let mut page = Page::opened(EPOCH_MS + 3_600_000.0);
    page.recorder.add_event(&at(0, reply(1, 7)));
    page.restore(&disk);
    page.pass(300);
    assert!(past(&page).is_empty());
    let mut page = Page::opened(EPOCH_MS + 3_600_000.0);
    page.restore(&disk);
    page.pass(300);
    assert!(!past(&page).is_empty(), "nothing newer is there");
}

/// Clocks go back by an hour two seconds after the start of the previous session.
#[test]
fn restored_rows_have_the_local_time_of_their_moment() {
    const CHANGED_MS: i64 = 1_795_266_902_000;
    let local_time = |from_ms, until_ms| {
        let minutes_at = |unix_ms| if unix_ms < CHANGED_MS { 120 } else { 60 };
        LocalTime::between(from_ms, until_ms, minutes_at)
    };
    let begun_ms = CHANGED_MS - 2_000;
    let mut first = Page::opened(EPOCH_MS);
    first.add_message(1_000, "in summer");
    first.recorder.add_event(&at(1_001, reply(1, 7)));
    first.add_message(3_000, "in winter");
    let disk = first.crash();
    let mut page = Page::opened(EPOCH_MS + 60_000.0);
    page.add_message(0, "now");
    page.recorder
        .set_local_time(local_time(begun_ms, begun_ms + 60_000));
    page.restore(&disk);
    // As the worker does once a minute.
    let begins_ms = page.recorder.begins_ms().unwrap();
    assert_eq!(begins_ms, begun_ms);
    page.recorder
        .set_local_time(local_time(begins_ms, begun_ms + 120_000));
    page.pass(300);
    page.told.clear();
    page.handle(ToRecorder::Show(crate::line::ALL));
    let rows = page.told.iter().find_map(|told| match told {
        FromRecorder::Log(page) => Some(&page.rows),
        _ => None,
    });
    let times: Vec<&str> = rows.unwrap().iter().map(|row| row.time.as_str()).collect();
    assert_eq!(
        times,
        [
            "15:15:01.000",
            "15:15:01.001",
            "14:15:03.000",
            "14:16:00.000"
        ]
    );
}

#[test]
fn a_wall_clock_that_was_set_back_puts_nothing_before_what_was_restored() {
    let mut page = Page::opened(EPOCH_MS);
    page.drive(0..2_000);
    let disk = page.crash();
    let mut page = restored(&disk, EPOCH_MS - 60_000.0);
    page.add_message(5, "now");
    page.drive(10..20);
    let log = page.export(Export::Log);
    let lines: Vec<&str> = log.lines().collect();
    assert!(lines[2_001].contains("now"), "{}", lines[2_001]);
    assert!(lines[2_001].starts_with("2026-11-21T13:15:01.999Z"));
    assert!(lines[2_002].starts_with("2026-11-21T13:15:02.004Z"));
}

#[test]
fn what_was_cleared_stays_cleared_and_samples_stay() {
    let mut page = Page::opened(EPOCH_MS);
    page.drive(0..1_000);
    page.handle(ToRecorder::Clear);
    page.drive(1_000..1_100);
    let rolling = page.recording().rolling;
    let disk = page.crash();
    assert_eq!(summary(&disk).session().unwrap().packets, 100);
    let mut page = restored(&disk, LATER_MS);
    assert_eq!(page.export(Export::Log).lines().count(), 101);
    assert_eq!(page.recording().rolling, rolling);
}

#[test]
fn what_was_cleared_by_mistake_is_back_in_its_order_and_in_the_saved_session() {
    let mut page = Page::opened(EPOCH_MS);
    page.drive(0..1_000);
    page.add_message(1_000, "before");
    let before = page.export(Export::Log);
    page.handle(ToRecorder::Clear);
    assert_eq!(
        page.export(Export::Log).lines().count(),
        0,
        "nothing to export"
    );
    page.drive(1_000..1_100);
    page.add_message(1_100, "since");
    page.handle(ToRecorder::EndClear { undo: true });
    let log = page.export(Export::Log);
    assert!(log.starts_with(&before), "{log}");
    assert_eq!(log.lines().count(), before.lines().count() + 101);
    assert!(log.contains("since"));
    // Once.
    page.handle(ToRecorder::EndClear { undo: true });
    assert_eq!(page.export(Export::Log), log);
    let disk = page.crash();
    assert_eq!(summary(&disk).session().unwrap().packets, 1_100);
    let mut page = restored(&disk, LATER_MS);
    assert_eq!(page.export(Export::Log), log);
    // What was forgotten stays cleared.
    page.handle(ToRecorder::Clear);
    page.handle(ToRecorder::EndClear { undo: false });
    page.handle(ToRecorder::EndClear { undo: true });
    page.drive(1_100..1_110);
    assert_eq!(page.export(Export::Log).lines().count(), 11);
}

#[test]
fn a_recording_that_starts_again_takes_its_files_along() {
    let mut page = Page::opened(EPOCH_MS);
    page.handle(ToRecorder::Record(true));
    page.drive(0..1_000);
    page.handle(ToRecorder::Record(false));
    page.export(Export::Telemetry);
    page.pass(300);
    let recorded = |disk: &Disk| {
        let files = disk.keys().filter(|file| file.stream == Stream::Recorded);
        files.copied().collect::<Vec<_>>()
    };
    let before = recorded(&page.disk);
    page.handle(ToRecorder::Record(true));
    page.drive(1_000..1_100);
    page.pass(300);
    let after = recorded(&page.disk);
    assert_eq!((before.len(), after.len()), (1, 1));
    assert_ne!(before, after);
    let status = page.recording();
    let disk = page.crash();
    assert_eq!(
        restored(&disk, LATER_MS).recording().recorded,
        status.recorded
    );
}

#[test]
fn written_within_a_quarter_of_a_second_and_at_rest_not_at_all() {
    let mut page = Page::opened(EPOCH_MS);
    page.pass(10_000);
    assert!(page.disk.is_empty());
    assert_eq!(page.run(), None, "no timer");
    page.drive(0..10);
    assert!(page.disk.is_empty(), "not a write an entry");
    let due = page.run().unwrap();
    assert!(due.since(page.now) <= Duration::from_millis(250));
    page.now = due;
    page.run();
    assert_eq!(page.disk.len(), 1);
    page.pass(200);
    page.pass(6_000);
    assert_eq!(page.flushes, 1);
    assert_eq!(page.run(), None, "no timer");
}

#[test]
fn times_are_kept_from_the_epoch_on_though_something_came_before_it() {
    let mut page = Page::opened(EPOCH_MS);
    page.recorder = Recorder::new(WallClock::new(EPOCH_MS, 0)).saving();
    page.add_message(3, "early");
    page.pass(5_000);
    assert!(page.disk.is_empty());
    page.handle(ToRecorder::Epoch { unix_ms: EPOCH_MS });
    page.drive(5..6);
    let disk = page.crash();
    let log = restored(&disk, LATER_MS).export(Export::Log);
    assert!(log.contains("2026-11-21T13:15:00.003Z"), "{log}");
}

#[test]
fn a_long_session_is_bounded_and_keeps_a_million_entries() {
    let mut page = Page::opened(EPOCH_MS);
    for second in 0..1_300 {
        // From the tenth hour on, when times take most bytes.
        let start = 34_000_000 + second * 1_000;
        page.drive(start..start + 1_000);
        for part in 0..20 {
            // As long as that of four motors.
            page.show(start + part * 50, 75);
        }
        page.pass(260);
    }
    let sizes: Vec<usize> = page.disk.values().map(Vec::len).collect();
    assert!(sizes.iter().all(|size| *size <= SEGMENT_BYTES_MAX + 40));
    let bytes: usize = sizes.iter().sum();
    assert!(
        bytes <= PACKETS_BYTES_MAX + 2 * SEGMENT_BYTES_MAX,
        "{bytes}"
    );
    let disk = page.crash();
    let packets = summary(&disk).session().unwrap().packets;
    assert_eq!(packets, 1_000_000);
    let mut page = restored(&disk, LATER_MS);
    let lines = page.export(Export::Log).lines().count();
    assert!((1_000_001..1_100_000).contains(&lines), "{lines}");
}

/// The states that are kept: when, and the time of what they show.
fn states(recorder: &mut Recorder) -> Vec<(u64, u64)> {
    let Kept::Part { records, .. } = recorder.first_kept(SaveRange::Line, 1_000) else {
        return Vec::new();
    };
    let states = records.into_iter().filter_map(|record| match record {
        KeptRecord::State { at, stored } => {
            let sample = stored_state::read(&stored, at)?.samples[0].at;
            Some((at.as_micros() / 1_000, sample.as_micros() / 1_000))
        }
        _ => None,
    });
    states.collect()
}

#[test]
fn what_the_page_showed_is_restored_with_the_log() {
    let mut page = Page::opened(EPOCH_MS);
    page.drive(0..4);
    page.show(2, 1);
    page.pass(300);
    let mut page = restored(&page.crash(), EPOCH_MS + 10_000.0);
    // In the time of the run before.
    assert_eq!(states(&mut page.recorder), [(2, 2)]);
    page.drive(5..6);
    page.show(6, 1);
    assert_eq!(states(&mut page.recorder), [(2, 2), (10_006, 10_006)]);
    page.handle(ToRecorder::Clear);
    page.drive(8..9);
    page.show(9, 1);
    assert_eq!(states(&mut page.recorder), [(10_009, 10_009)]);
    page.handle(ToRecorder::EndClear { undo: true });
    let all = [(2, 2), (10_006, 10_006), (10_009, 10_009)];
    assert_eq!(states(&mut page.recorder), all);
}

/// The file that names the model may be gone.
#[test]
fn frames_are_explained_by_their_model_in_every_file_of_a_saved_session() {
    let mut page = Page::opened(EPOCH_MS);
    let begins = LineEventKind::ModelSelected(Model::Ddsm400);
    page.recorder.add_event(&at(0, begins));
    for second in 0..200 {
        page.drive(second * 1_000..(second + 1) * 1_000);
        page.pass(260);
    }
    let mut disk = page.crash();
    assert!(disk.len() >= 2, "{} files", disk.len());
    disk.pop_first();
    let mut page = restored(&disk, LATER_MS);
    let log = page.export(Export::Log);
    // Its drive frames are in tenths of a rpm.
    assert!(log.contains(",drive +5 rpm"));
    assert!(!log.contains(",drive +50 rpm"));
}

#[test]
fn erased_is_erased_and_the_session_starts_again() {
    let mut page = Page::opened(EPOCH_MS);
    page.handle(ToRecorder::Record(true));
    page.drive(0..1_000);
    page.handle(ToRecorder::Record(false));
    page.pass(300);
    page.handle(ToRecorder::Erase);
    assert!(page.told.contains(&FromRecorder::Erased { all: true }));
    assert!(page.disk.is_empty());
    assert_eq!(page.recording(), RecordingStatus::default());
    page.drive(1_000..1_010);
    let disk = page.crash();
    let mut page = restored(&disk, LATER_MS);
    assert_eq!(page.export(Export::Log).lines().count(), 11);
}

#[test]
fn a_file_that_is_missing_or_foreign_costs_only_itself() {
    let mut page = Page::opened(EPOCH_MS);
    for second in 0..300 {
        page.drive(second * 1_000..(second + 1) * 1_000);
        page.pass(260);
    }
    let mut disk = page.crash();
    let files: Vec<Segment> = disk.keys().copied().collect();
    assert!(files.len() >= 3);
    let lost = disk.insert(files[1], b"MLnothing of ours ML\xB1\x02".to_vec());
    let lost = summary(&Disk::from([(files[1], lost.unwrap())]));
    let lost = lost.session().unwrap().packets;
    let mut page = restored(&disk, LATER_MS);
    let lines = page.export(Export::Log).lines().count() as u64;
    assert_eq!(lines, 1 + 300_000 - lost);
}

#[test]
fn what_comes_while_a_session_is_restored_is_in_it_and_in_the_file_that_waits() {
    let mut page = Page::opened(EPOCH_MS);
    page.drive(0..5_000);
    let disk = page.crash();
    let mut page = Page::opened(LATER_MS);
    page.kept = disk.clone().into_iter().collect();
    page.recorder.restore(&summary(&disk), &[]);
    let mut n = 0;
    let mut asked = false;
    while !page.told.contains(&FromRecorder::Restored) {
        page.recorder.add_event(&at(n, reply(1, 7)));
        n += 1;
        if n == 5 {
            page.recorder.handle(ToRecorder::Export(Export::Log));
            asked = true;
        }
        match page.recorder.poll(page.now) {
            Output::NextFile => {
                let next = page.kept.pop();
                let next = next.map(|(segment, bytes)| (segment.stream, bytes));
                page.recorder.next_file(next);
            }
            Output::Work => page.recorder.work(page.now, 100),
            Output::Post(message) => page.told.push(message),
            _ => page.now = page.now + Duration::from_millis(1),
        }
    }
    assert!(asked);
    page.run();
    let log = page.file.take().unwrap();
    // The export began when the logs were exchanged, and the page was told one entry later.
    assert_eq!(log.lines().count() as u64, 1 + 5_000 + n - 1);
}
