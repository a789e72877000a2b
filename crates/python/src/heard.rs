//! What happened on the line since the program asked last.

use std::collections::{BTreeMap, VecDeque};

use motorlink_bus::{Event, Mirror, Refusal, StopReason, StopReport};
use motorlink_command::library::{Heard, ends_drive};
use motorlink_driver::Entry;
use motorlink_protocol::{Instant, MotorId, family::Model};

use crate::reading::{Reading, Readings};

/// Readings that wait for a program: twenty seconds at 500 Hz. The oldest are dropped.
const READINGS_MAX: usize = 10_000;
/// Notes that wait for a program.
const NOTES_MAX: usize = 100;

/// A program that takes the readings of some motors.
#[derive(Debug)]
struct Reader {
    motors: Vec<MotorId>,
    readings: VecDeque<Reading>,
}

/// What the program has not taken yet.
#[derive(Debug)]
pub struct News {
    model: Model,
    opened: Option<Instant>,
    readings: Readings,
    latest: BTreeMap<MotorId, Reading>,
    readers: BTreeMap<u32, Reader>,
    next_reader: u32,
    pub mirrors: BTreeMap<MotorId, Mirror>,
    pub notes: VecDeque<String>,
    /// Why a drive ended without being asked to.
    pub trouble: Option<String>,
    last_note: String,
    /// The stops that have ended.
    pub stops: Vec<StopReport>,
    was_lost: bool,
}

impl News {
    pub fn new(model: Model) -> Self {
        Self {
            model,
            opened: None,
            readings: Readings::default(),
            latest: BTreeMap::new(),
            readers: BTreeMap::new(),
            next_reader: 0,
            mirrors: BTreeMap::new(),
            notes: VecDeque::new(),
            trouble: None,
            last_note: String::new(),
            stops: Vec::new(),
            was_lost: false,
        }
    }

    /// Takes what happens. A note comes before the entry that it is about.
    pub fn take(&mut self, heard: Heard<'_>) {
        match heard {
            Heard::Note(text) => {
                if self.notes.len() >= NOTES_MAX {
                    self.notes.pop_front();
                }
                self.last_note.clone_from(&text);
                self.notes.push_back(text);
            }
            Heard::Entry(at, entry) => {
                let opened = *self.opened.get_or_insert(at);
                self.entry(entry, opened);
            }
        }
    }

    fn entry(&mut self, entry: &Entry, opened: Instant) {
        match entry {
            Entry::Event(Event::Telemetry(sample)) => {
                let id = sample.reply.id;
                let mirror = self.mirrors.get(&id).copied().unwrap_or(Mirror::Straight);
                let reading = self.readings.of(self.model, sample, mirror, opened);
                for reader in self.readers.values_mut() {
                    if reader.motors.contains(&id) {
                        if reader.readings.len() >= READINGS_MAX {
                            reader.readings.pop_front();
                        }
                        reader.readings.push_back(reading.clone());
                    }
                }
                self.latest.insert(id, reading);
            }
            Entry::Event(Event::StopEnded(report)) => {
                // Only the stops of one call are looked at.
                if self.stops.len() >= NOTES_MAX {
                    self.stops.clear();
                }
                self.stops.push(report.clone());
            }
            _ => {}
        }
        let is_lost = matches!(entry, Entry::PortLost { .. });
        self.was_lost |= is_lost;
        if is_lost || ends_drive(entry, self.was_lost) {
            self.trouble = Some(match entry {
                Entry::Event(Event::StopBegan(StopReason::PageSilent)) => {
                    "the motors were stopped: the program did not call motorlink for a second. Wait with bus.sleep(), \
                     or open with keepalive=False; then bus.release() and drive again"
                        .to_owned()
                }
                Entry::Refused {
                    refusal: Refusal::Halted,
                    ..
                } => "all motors are stopped: call bus.release() to drive again".to_owned(),
                _ => self.last_note.clone(),
            });
        }
    }

    pub fn latest(&self, id: MotorId) -> Option<Reading> {
        self.latest.get(&id).cloned()
    }

    pub fn add_reader(&mut self, motors: Vec<MotorId>) -> u32 {
        self.next_reader += 1;
        let readings = VecDeque::new();
        self.readers
            .insert(self.next_reader, Reader { motors, readings });
        self.next_reader
    }

    pub fn remove_reader(&mut self, reader: u32) {
        self.readers.remove(&reader);
    }

    pub fn take_readings(&mut self, reader: u32) -> Vec<Reading> {
        let reader = self.readers.get_mut(&reader);
        reader.map_or_else(Vec::new, |reader| reader.readings.drain(..).collect())
    }
}
