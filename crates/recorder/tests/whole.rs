//! The recorder as the worker runs it: messages in, messages and files out.

use std::time::Duration;

use motorlink_messages::recorder::{
    Export, FromRecorder, LogPage, RecordingStatus, ToRecorder, Window,
};
use motorlink_protocol::Instant;
use motorlink_recorder::{Log, Output, Recorder, Recording, WallClock};

use crate::line::{ALL, at, collapsed, driven, query, reply};

/// The recorder and its caller.
struct Caller {
    recorder: Recorder,
    now: Instant,
    told: Vec<FromRecorder>,
    parts: Vec<u8>,
    file: Option<String>,
    /// Slices of work that the recorder requested.
    worked: u32,
}

impl Caller {
    fn new() -> Self {
        let own_clock = WallClock::new(1_795_266_900_000.0, 60);
        let recorder = Recorder::with(own_clock, Log::with_capacity(10_000), Recording::default());
        let mut caller = Self {
            recorder,
            now: Instant::ZERO,
            told: Vec::new(),
            parts: Vec::new(),
            file: None,
            worked: 0,
        };
        let unix_ms = 1_795_266_936_962.0;
        caller.handle(ToRecorder::Epoch { unix_ms });
        caller
    }

    fn handle(&mut self, message: ToRecorder) {
        self.recorder.handle(message);
        self.run();
    }

    fn drive(&mut self, numbers: std::ops::Range<u64>) {
        for n in numbers {
            self.recorder.add_event(&driven(n));
        }
        self.run();
    }

    /// Advances the time in steps of one millisecond.
    fn pass(&mut self, millis: u32) {
        for _ in 0..millis {
            self.now = self.now + Duration::from_millis(1);
            self.run();
        }
    }

    /// Polls until the recorder waits. Every slice of work takes a millisecond.
    fn run(&mut self) -> Option<Instant> {
        loop {
            match self.recorder.poll(self.now) {
                Output::Post(message) => self.told.push(message),
                Output::Part(mut bytes) => self.parts.append(&mut bytes),
                Output::File(message) => {
                    self.told.push(message);
                    self.file = Some(String::from_utf8(std::mem::take(&mut self.parts)).unwrap());
                }
                Output::NoFile(message) => {
                    self.told.push(message);
                    self.parts.clear();
                }
                Output::Work => {
                    self.worked += 1;
                    self.now = self.now + Duration::from_millis(1);
                    self.recorder.work(self.now, 500);
                }
                Output::Store(_) | Output::NextFile => panic!("nothing is kept here"),
                Output::Wait(until) => return until,
            }
        }
    }

    fn pages(&mut self) -> Vec<LogPage> {
        let told = std::mem::take(&mut self.told).into_iter();
        told.filter_map(|message| match message {
            FromRecorder::Log(page) => Some(page),
            _ => None,
        })
        .collect()
    }

    fn statuses(&mut self) -> Vec<RecordingStatus> {
        let told = std::mem::take(&mut self.told).into_iter();
        told.filter_map(|message| match message {
            FromRecorder::Recording(status) => Some(status),
            _ => None,
        })
        .collect()
    }
}

#[test]
fn a_look_is_answered_and_nothing_is_told_before_it() {
    let mut caller = Caller::new();
    caller.drive(0..10);
    assert!(caller.pages().is_empty());
    caller.handle(ToRecorder::Show(ALL));
    let pages = caller.pages();
    assert_eq!(pages.len(), 1);
    assert_eq!(pages[0].rows.len(), 10);
    assert_eq!(pages[0].rows[0].time, "14:15:36.962", "local time");
}

#[test]
fn pages_are_told_at_most_thirty_times_a_second_and_only_of_changes() {
    let mut caller = Caller::new();
    caller.handle(ToRecorder::Show(ALL));
    caller.pass(100);
    caller.told.clear();
    for second in 0..10 {
        for step in 0..100 {
            let n = second * 100 + step;
            caller.drive(n..n + 1);
            caller.pass(10);
        }
    }
    let pages = caller.pages();
    assert!(
        (200..=300).contains(&pages.len()),
        "{} in 10 s",
        pages.len()
    );
    assert_eq!(pages.last().unwrap().end, 1_000);
    caller.pass(100);
    caller.told.clear();
    caller.pass(1_000);
    assert!(caller.pages().is_empty(), "nothing has changed");
    assert_eq!(caller.run(), None, "and nothing is waited for");
}

#[test]
fn a_page_that_has_to_wait_is_not_forgotten() {
    let mut caller = Caller::new();
    caller.handle(ToRecorder::Show(ALL));
    caller.told.clear();
    caller.drive(0..5);
    assert!(
        caller
            .told
            .iter()
            .all(|told| !matches!(told, FromRecorder::Log(_)))
    );
    let until = caller.run().unwrap();
    assert!(until <= caller.now + Duration::from_millis(34));
    caller.now = until;
    caller.run();
    assert_eq!(caller.pages().len(), 1);
}

#[test]
fn a_filter_shows_its_first_rows_before_it_is_through() {
    let mut caller = Caller::new();
    let window = Window {
        first: None,
        rows: 40,
    };
    caller.handle(ToRecorder::Show(window));
    caller.drive(0..10_000);
    caller.pass(100);
    caller.told.clear();
    caller.handle(ToRecorder::Filter(collapsed()));
    caller.pass(100);
    let pages = caller.pages();
    assert!(caller.worked >= 19);
    assert!(pages[0].filtered_per_mille < 1000);
    let last = pages.last().unwrap();
    assert_eq!(last.filtered_per_mille, 1000);
    assert_eq!(last.collapsed + (last.end - last.oldest), 10_000);
    assert_eq!(last.generation, pages[0].generation);
}

#[test]
fn the_recording_is_told_at_most_five_times_a_second() {
    let mut caller = Caller::new();
    caller.pass(500);
    assert!(caller.statuses().is_empty(), "nothing has changed");
    caller.handle(ToRecorder::Record(true));
    assert!(caller.statuses()[0].recording);
    for n in 0..1_000 {
        caller.drive(n..n + 1);
        caller.pass(1);
    }
    caller.pass(200);
    let statuses = caller.statuses();
    assert!(
        (5..=6).contains(&statuses.len()),
        "{} in 1.2 s",
        statuses.len()
    );
    assert_eq!(statuses.last().unwrap().recorded, 500);
}

#[test]
fn an_exported_log_is_a_file_with_a_name_and_its_rows() {
    let mut caller = Caller::new();
    caller.drive(0..10_000);
    caller.told.clear();
    caller.now = Instant::from_millis(36_962);
    caller.handle(ToRecorder::Export(Export::Log));
    let name = "motorlink-log-20261121-141536.csv".into();
    let exported = FromRecorder::Exported {
        what: Export::Log,
        name,
        rows: 10_000,
    };
    assert_eq!(caller.told.last(), Some(&exported));
    let what = Export::Log;
    let begun = FromRecorder::Exporting {
        what,
        done: 0,
        of: 10_000,
    };
    assert_eq!(caller.told.first(), Some(&begun));
    assert_eq!(caller.file.unwrap().lines().count(), 10_001);
}

#[test]
fn an_exported_recording_is_known_to_be_exported() {
    let mut caller = Caller::new();
    caller.handle(ToRecorder::Record(true));
    caller.drive(0..100);
    caller.handle(ToRecorder::Record(false));
    caller.handle(ToRecorder::Export(Export::Telemetry));
    let named = caller.told.iter().find_map(|told| match told {
        FromRecorder::Exported { what, name, rows } => Some((*what, name.clone(), *rows)),
        _ => None,
    });
    let (what, name, rows) = named.unwrap();
    assert_eq!((what, rows), (Export::Telemetry, 50));
    let stamp = name.strip_prefix("motorlink-telemetry-20261121-");
    assert!(
        stamp.is_some_and(|stamp| stamp.len() == "141536.csv".len()),
        "{name}"
    );
    caller.pass(200);
    let status = *caller.statuses().last().unwrap();
    assert!(status.exported && !status.recording);
    caller.handle(ToRecorder::Clear);
    caller.pass(500);
    assert_eq!(caller.statuses(), [], "the recording stays");
}

#[test]
fn nothing_to_write_is_said() {
    let mut caller = Caller::new();
    for what in [Export::Log, Export::Telemetry, Export::Plot] {
        caller.handle(ToRecorder::Export(what));
        let cancelled = false;
        assert_eq!(
            caller.told.pop(),
            Some(FromRecorder::NotExported { what, cancelled })
        );
    }
}

#[test]
fn a_cancelled_export_gives_no_file_and_the_next_one_a_whole_file() {
    let mut caller = Caller::new();
    caller.drive(0..10_000);
    caller.recorder.handle(ToRecorder::Export(Export::Log));
    for _ in 0..5 {
        caller.recorder.work(caller.now, 500);
    }
    caller.told.clear();
    caller.handle(ToRecorder::CancelExport);
    let cancelled = FromRecorder::NotExported {
        what: Export::Log,
        cancelled: true,
    };
    assert_eq!(caller.told, [cancelled]);
    assert!(caller.file.is_none());
    caller.handle(ToRecorder::Export(Export::Log));
    assert_eq!(caller.file.unwrap().lines().count(), 10_001);
}

#[test]
fn every_file_can_be_wanted_at_once_and_none_twice() {
    let mut caller = Caller::new();
    caller.drive(0..1_000);
    caller.told.clear();
    for what in [Export::Log, Export::Telemetry, Export::Log, Export::Plot] {
        caller.recorder.handle(ToRecorder::Export(what));
    }
    caller.run();
    let exported: Vec<_> = caller
        .told
        .iter()
        .filter_map(|told| match told {
            FromRecorder::Exported { what, .. } => Some(*what),
            _ => None,
        })
        .collect();
    assert_eq!(exported, [Export::Log, Export::Telemetry, Export::Plot]);
    assert!(
        caller
            .file
            .unwrap()
            .starts_with("time,motor_1_unmirrored_speed_rpm,")
    );
}

#[test]
fn frames_are_taken_in_while_a_file_is_made() {
    let mut caller = Caller::new();
    caller.drive(0..5_000);
    caller.recorder.handle(ToRecorder::Export(Export::Log));
    let mut worked = 0;
    loop {
        match caller.recorder.poll(caller.now) {
            Output::Work => {
                worked += 1;
                caller.recorder.work(caller.now, 100);
                caller.recorder.add_event(&at(5_000 + worked, query(1)));
                caller.recorder.add_event(&at(5_000 + worked, reply(1, 0)));
            }
            Output::File(FromRecorder::Exported { rows, .. }) => {
                assert_eq!(rows, 5_000, "without what came later");
                break;
            }
            Output::Wait(_) => panic!("the file is not made"),
            _ => {}
        }
    }
    caller.handle(ToRecorder::Show(ALL));
    assert_eq!(caller.pages()[0].kept, 5_000 + 2 * worked);
}
