//! What happened on the line since the program asked last.

use std::collections::{BTreeMap, VecDeque};

use motorlink_bus::{Event, FRESH_FOR, Refusal, Sample, StopReason, StopReport};
use motorlink_command::library::{Heard, SignedId, ends_drive, words_of};
use motorlink_driver::Entry;
use motorlink_protocol::{Instant, MotorId, family::Model};

use crate::reading::{Reading, Temperatures};

/// Readings that wait for a program: twenty seconds at 500 Hz. The oldest are dropped.
const READINGS_MAX: usize = 10_000;
/// Notes, stops, and messages of a run that wait for a program. The oldest are dropped.
const NEWS_MAX: usize = 1_000;

/// A program that takes the readings of some motors.
#[derive(Debug)]
struct Reader {
    motors: Vec<SignedId>,
    readings: VecDeque<Reading>,
}

/// What the program has not taken yet.
#[derive(Debug)]
pub struct News {
    model: Model,
    opened: Instant,
    temperatures: Temperatures,
    latest: BTreeMap<MotorId, Sample>,
    readers: BTreeMap<u32, Reader>,
    next_reader: u32,
    notes: VecDeque<String>,
    /// Why a drive ended without being asked to: of a motor, or of the whole line.
    troubles: BTreeMap<Option<MotorId>, String>,
    /// The stops that have ended, with their numbers.
    stops: VecDeque<(u64, StopReport)>,
    next_stop: u64,
    /// What the run of an experiment has said.
    run: VecDeque<Entry>,
    was_lost: bool,
}

impl News {
    /// Of a line that was opened at this time.
    pub fn new(model: Model, opened: Instant) -> Self {
        Self {
            model,
            opened,
            temperatures: Temperatures::default(),
            latest: BTreeMap::new(),
            readers: BTreeMap::new(),
            next_reader: 0,
            notes: VecDeque::new(),
            troubles: BTreeMap::new(),
            stops: VecDeque::new(),
            next_stop: 0,
            run: VecDeque::new(),
            was_lost: false,
        }
    }

    /// Takes what happens.
    pub fn take(&mut self, heard: Heard<'_>) {
        match heard {
            Heard::Note(text) => push(&mut self.notes, text, NEWS_MAX),
            Heard::Entry(_, entry) => self.entry(entry),
        }
    }

    fn entry(&mut self, entry: &Entry) {
        match entry {
            Entry::Event(Event::Telemetry(sample)) => self.sample(sample),
            Entry::Event(Event::StopEnded(report)) => {
                let number = self.next_stop;
                self.next_stop += 1;
                push(&mut self.stops, (number, report.clone()), NEWS_MAX);
                let others = report.motors.iter().filter(|motor| !motor.confirmed);
                for motor in others {
                    let id = motor.id;
                    let text = format!("motor {id} may turn: cut its power");
                    push(&mut self.notes, text.clone(), NEWS_MAX);
                    self.troubles.insert(Some(id), text);
                }
            }
            Entry::Run(_) => push(&mut self.run, entry.clone(), NEWS_MAX),
            _ => {}
        }
        let is_lost = matches!(entry, Entry::PortLost { .. });
        self.was_lost |= is_lost;
        if is_lost || ends_drive(entry, self.was_lost) {
            let (id, text) = trouble(entry);
            self.troubles.insert(id, text);
        }
    }

    fn sample(&mut self, sample: &Sample) {
        let id = sample.reply.id;
        self.temperatures.note(sample);
        self.latest.insert(id, *sample);
        let (model, opened) = (self.model, self.opened);
        for reader in self.readers.values_mut() {
            if let Some(motor) = reader.motors.iter().find(|motor| motor.id == id) {
                let celsius = self.temperatures.fresh(sample);
                let reading = Reading::of(model, sample, motor.mirror, opened, celsius);
                push(&mut reader.readings, reading, READINGS_MAX);
            }
        }
    }

    /// The last reading, if it is fresh at this time.
    pub fn latest(&self, motor: SignedId, now: Instant) -> Option<Reading> {
        let sample = self.latest.get(&motor.id)?;
        let celsius = self.temperatures.fresh(sample);
        (now.since(sample.at) <= FRESH_FOR)
            .then(|| Reading::of(self.model, sample, motor.mirror, self.opened, celsius))
    }

    pub fn add_reader(&mut self, motors: Vec<SignedId>) -> u32 {
        self.next_reader += 1;
        let readings = VecDeque::new();
        self.readers
            .insert(self.next_reader, Reader { motors, readings });
        self.next_reader
    }

    pub fn remove_reader(&mut self, reader: u32) {
        self.readers.remove(&reader);
    }

    /// The motors of a reader, and its readings since the last call.
    pub fn take_readings(&mut self, reader: u32) -> (Vec<MotorId>, Vec<Reading>) {
        let Some(reader) = self.readers.get_mut(&reader) else {
            return (Vec::new(), Vec::new());
        };
        let ids = reader.motors.iter().map(|motor| motor.id);
        (ids.collect(), reader.readings.drain(..).collect())
    }

    pub fn take_notes(&mut self) -> Vec<String> {
        self.notes.drain(..).collect()
    }

    /// Takes what the run of an experiment has said next.
    pub fn take_run(&mut self) -> Option<Entry> {
        self.run.pop_front()
    }

    /// Takes why the drive of one of these motors ended, or that of all.
    pub fn take_trouble(&mut self, motors: &[MotorId]) -> Option<String> {
        let mut all = motors.iter().copied().map(Some).chain([None]);
        all.find_map(|of| self.troubles.remove(&of))
    }

    /// Takes why a drive ended, whichever it is.
    pub fn take_any_trouble(&mut self) -> Option<String> {
        self.troubles.pop_first().map(|(_, text)| text)
    }

    /// The number of the next stop that ends.
    pub const fn next_stop(&self) -> u64 {
        self.next_stop
    }

    /// The stops that have ended since this number.
    pub fn stops_since(&self, number: u64) -> impl Iterator<Item = &StopReport> {
        let since = self.stops.iter().filter(move |(of, _)| *of >= number);
        since.map(|(_, report)| report)
    }
}

fn push<T>(queue: &mut VecDeque<T>, item: T, max: usize) {
    if queue.len() >= max {
        queue.pop_front();
    }
    queue.push_back(item);
}

/// The motor of an entry that ends a drive, and why.
fn trouble(entry: &Entry) -> (Option<MotorId>, String) {
    let id = match entry {
        Entry::Event(
            Event::NotStarted { id, .. }
            | Event::Withdrawn { id, .. }
            | Event::ModeSwitchFailed { id, .. },
        ) => Some(*id),
        _ => None,
    };
    let text = match entry {
        Entry::Event(Event::StopBegan(StopReason::PageSilent)) => {
            "the motors were stopped: the program did not call motorlink for a second. Wait with bus.sleep(), or open with \
             keepalive=False; then bus.release() and drive again"
                .to_owned()
        }
        Entry::Refused {
            refusal: Refusal::Halted,
            ..
        } => "all motors are stopped: call bus.release() to drive again".to_owned(),
        entry => words_of(entry).unwrap_or_else(|| "it was not done: try again".to_owned()),
    };
    (id, text)
}
