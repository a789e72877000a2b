//! A page whose recorder saves its session in memory.

use std::{collections::BTreeMap, time::Duration};

use motorlink_bus::Sample;
use motorlink_messages::{
    Connection, ToPage, Update, encode,
    recorder::{Export, FromRecorder, RecordingStatus, ToRecorder},
};
use motorlink_protocol::{Instant, Reply};
use motorlink_recorder::{
    Log, Output, Recorder, Recording, WallClock,
    saved::{Segment, StoreAction, Stream, Summary},
};

use crate::line::driven;

/// 2026-11-21 13:15:00 UTC.
pub const EPOCH_MS: f64 = 1_795_266_900_000.0;

/// The files of a session.
pub type Disk = BTreeMap<Segment, Vec<u8>>;

/// A page with a recorder that saves its session.
pub struct Page {
    pub recorder: Recorder,
    pub now: Instant,
    pub disk: Disk,
    /// What is restored.
    pub kept: Vec<(Segment, Vec<u8>)>,
    pub told: Vec<FromRecorder>,
    parts: Vec<u8>,
    pub file: Option<String>,
    pub flushes: u32,
}

impl Page {
    pub fn opened(epoch_ms: f64) -> Self {
        let clock = WallClock::new(epoch_ms, 0);
        let log = Log::with_capacity(1_100_000);
        let mut page = Self {
            recorder: Recorder::with(clock, log, Recording::default()).saving(),
            now: Instant::ZERO,
            disk: Disk::new(),
            kept: Vec::new(),
            told: Vec::new(),
            parts: Vec::new(),
            file: None,
            flushes: 0,
        };
        page.handle(ToRecorder::Epoch { unix_ms: epoch_ms });
        page
    }

    pub fn handle(&mut self, message: ToRecorder) {
        self.recorder.handle(message);
        self.run();
    }

    pub fn add_message(&mut self, millis: u64, text: &str) {
        self.handle(ToRecorder::AddMessage {
            at: Instant::from_millis(millis),
            error: false,
            text: text.to_owned(),
        });
    }

    pub fn drive(&mut self, numbers: std::ops::Range<u64>) {
        for n in numbers {
            self.recorder.add_event(&driven(n));
        }
        self.run();
    }

    /// The page shows these replies.
    pub fn show(&mut self, at_ms: u64, replies: u16) {
        self.recorder.add_state(update(at_ms, replies));
        self.run();
    }

    pub fn pass(&mut self, millis: u64) {
        self.now = self.now + Duration::from_millis(millis);
        self.run();
    }

    pub fn run(&mut self) -> Option<Instant> {
        loop {
            match self.recorder.poll(self.now) {
                Output::Post(message) | Output::NoFile(message) => self.told.push(message),
                Output::Part(mut bytes) => self.parts.append(&mut bytes),
                Output::File(message) => {
                    self.told.push(message);
                    self.file = Some(String::from_utf8(std::mem::take(&mut self.parts)).unwrap());
                }
                Output::Store(action) => self.perform(action),
                Output::NextFile => {
                    let next = (!self.kept.is_empty()).then(|| self.kept.remove(0));
                    let next = next.map(|(segment, bytes)| (segment.stream, bytes));
                    self.recorder.next_file(next);
                }
                Output::Work => self.recorder.work(self.now, 500),
                Output::Wait(until) => return until,
            }
        }
    }

    fn perform(&mut self, action: StoreAction) {
        match action {
            StoreAction::Append(segment, bytes) => {
                self.disk.entry(segment).or_default().extend(bytes);
            }
            StoreAction::Remove(segment) => _ = self.disk.remove(&segment),
            StoreAction::Flush => self.flushes += 1,
            StoreAction::Adopt { packets, recorded } => {
                for (mut segment, bytes) in std::mem::take(&mut self.disk) {
                    segment.number += match segment.stream {
                        Stream::Packets => packets,
                        Stream::Recorded => recorded,
                    };
                    self.disk.insert(segment, bytes);
                }
                self.disk.extend(self.kept.iter().cloned());
            }
            StoreAction::Erase => {
                self.disk.clear();
                self.told.push(FromRecorder::Erased { all: true });
            }
        }
    }

    /// The page crashes; the files are left.
    pub fn crash(mut self) -> Disk {
        self.pass(300);
        self.disk
    }

    pub fn restore(&mut self, disk: &Disk) {
        self.kept = disk.clone().into_iter().collect();
        let sizes = self.kept.iter();
        let files: Vec<_> = sizes.map(|(file, bytes)| (*file, bytes.len())).collect();
        self.recorder.restore(&summary(disk), &files);
        self.run();
    }

    pub fn export(&mut self, what: Export) -> String {
        self.file = None;
        self.handle(ToRecorder::Export(what));
        self.file.take().unwrap_or_default()
    }

    pub fn recording(&mut self) -> RecordingStatus {
        self.pass(300);
        let mut told = self.told.iter().rev();
        told.find_map(|message| match message {
            FromRecorder::Recording(status) => Some(*status),
            _ => None,
        })
        .unwrap_or_default()
    }
}

pub fn summary(disk: &Disk) -> Summary {
    let mut summary = Summary::default();
    for (segment, bytes) in disk {
        summary.add(segment.stream, bytes.clone());
    }
    summary
}

pub fn restored(disk: &Disk, epoch_ms: f64) -> Page {
    let mut page = Page::opened(epoch_ms);
    page.restore(disk);
    page
}

/// Half an hour later.
pub const LATER_MS: f64 = EPOCH_MS + 1_800_000.0;

/// A message to the page with so many replies.
fn update(at_ms: u64, replies: u16) -> Vec<u8> {
    let now = Instant::from_millis(at_ms);
    let frame = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
    let reply = Reply::decode(&frame, None).unwrap();
    let update = Update {
        now,
        connection: Connection::Disconnected,
        halted: false,
        motors: Vec::new(),
        job: None,
        raw: None,
        line: None,
        samples: (0..replies).map(|_| Sample { at: now, reply }).collect(),
        notices: Vec::new(),
    };
    encode(&ToPage::Update(update)).unwrap()
}
