//! What the recorder keeps, as one sequence in order of time: for a session file.
//!
//! The packet log has every frame, of a quarter of an hour at least. The recording goes further back, but has only
//! replies. So the sequence begins with the replies from before the log, with marks that say what else is known of
//! their motors. Behind that come the entries of the log.

use std::{ops::Range, time::Duration};

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_messages::sessions::{KeptRecord, Progress, SaveRange};
use motorlink_protocol::Instant;

use crate::{
    chunks::{Chunks, within},
    entry::{Entry, EntryContent},
    log::Log,
    marks::Marks,
    recording::{Recording, Sample, SampleSet},
};

/// Reads what is kept, part by part. What is added meanwhile is not in it. Of entries that are dropped before they are
/// read, it has the samples.
#[derive(Debug)]
pub(crate) struct KeptReader {
    entries: Range<u64>,
    samples: [(SampleSet, Range<u64>); 2],
    states: Range<u64>,
    /// What the records until here say of the model, and of motors without requests.
    marks: Marks,
    /// The time of the last entry of the line that was read.
    read_until: Option<Instant>,
    progress: Progress,
}

impl KeptReader {
    /// What is kept now, of one line.
    pub(crate) fn new(log: &mut Log, recording: &Recording, wanted: SaveRange) -> Self {
        let all = log.settle();
        let log = &*log;
        let entry_at = |number| Some(log.entries().get(number)?.at);
        let sample_at = |which, number| Some(recording.samples(which).get(number)?.at);
        let samples = |which| {
            let samples = recording.samples(which);
            samples.first()..samples.end()
        };
        let newest_sample = |which| sample_at(which, samples(which).end.checked_sub(1)?);
        // From the first to the last recorded sample of a line.
        let recorded = |line: &Range<Instant>| {
            let at = |number| sample_at(SampleSet::Recorded, number);
            let numbers = within(line, samples(SampleSet::Recorded), at);
            let last = numbers.clone().last().and_then(at)?;
            Some(at(numbers.start)?..last + Duration::from_micros(1))
        };
        let newest = [
            all.end.checked_sub(1).and_then(entry_at),
            newest_sample(SampleSet::Recorded),
            newest_sample(SampleSet::Rolling),
        ];
        let newest = newest.into_iter().flatten().max().unwrap_or_default();
        let line = |is_before| log.states().lines.span(is_before);
        let span = match wanted {
            SaveRange::Line => line(false),
            SaveRange::LineBefore => line(true),
            SaveRange::Last(last) => {
                let line = line(false);
                line.start.max(newest - last)..line.end
            }
            SaveRange::Recording => recorded(&line(false))
                .or_else(|| recorded(&line(true)))
                .unwrap_or_default(),
        };
        let range = |which| {
            let range = within(&span, samples(which), |number| sample_at(which, number));
            (which, range)
        };
        let entries = within(&span, all, entry_at);
        let mut reader = Self {
            samples: [range(SampleSet::Recorded), range(SampleSet::Rolling)],
            states: within(&span, log.states().numbers(), |number| {
                Some(log.states().get(number)?.at)
            }),
            marks: Marks::default(),
            entries,
            read_until: None,
            progress: Progress::default(),
        };
        reader.progress.of = reader.left();
        reader
    }

    fn left(&self) -> u64 {
        let samples = self.samples.iter().map(|(_, range)| range);
        let ranges = samples.chain([&self.entries, &self.states]);
        ranges
            .map(|range| range.end.saturating_sub(range.start))
            .sum()
    }

    /// How much has been read.
    pub(crate) const fn progress(&self) -> Progress {
        self.progress
    }

    /// Adds the records of at most this number of further entries and samples. Returns whether there are more.
    pub(crate) fn read(
        &mut self,
        log: &Log,
        recording: &Recording,
        most: u64,
        out: &mut Vec<KeptRecord>,
    ) -> bool {
        let has_more = (0..most).all(|_| self.step(log, recording, out));
        self.progress.done = self.progress.of.saturating_sub(self.left());
        has_more
    }

    /// Takes the oldest entry, sample or state. Returns whether there was one.
    fn step(&mut self, log: &Log, recording: &Recording, out: &mut Vec<KeptRecord>) -> bool {
        let entry = next(log.entries(), &mut self.entries);
        let [recorded, rolling] = &mut self.samples;
        let one = next(recording.samples(recorded.0), &mut recorded.1);
        let other = next(recording.samples(rolling.0), &mut rolling.1);
        let sample = match (one, other) {
            (Some(one), Some(other)) if other.at < one.at => Some(other),
            (one, other) => one.or(other),
        };
        // An entry goes before the sample that was made of it.
        let sample = sample.filter(|sample| entry.is_none_or(|entry| sample.at < entry.at));
        let at = sample
            .map(|sample| sample.at)
            .or(entry.map(|entry| entry.at));
        if let Some(state) = next_state(log, &mut self.states, at) {
            out.push(state);
            return true;
        }
        match (sample, entry) {
            (Some(sample), _) => {
                // The recording and the last ten minutes have the same samples.
                recorded.1.start += u64::from(one == Some(sample));
                rolling.1.start += u64::from(other == Some(sample));
                self.sample(sample, log, out);
            }
            (None, Some(entry)) => {
                self.entries.start += 1;
                self.entry(&entry, log, out);
            }
            (None, None) => return false,
        }
        true
    }

    fn entry(&mut self, entry: &Entry, log: &Log, out: &mut Vec<KeptRecord>) {
        let at = entry.at;
        let model = self.marks.model(at, entry.model);
        out.extend(model.map(KeptRecord::Line));
        out.push(match entry.content {
            EntryContent::Line(kind) => {
                self.read_until = Some(at);
                KeptRecord::Line(LineEvent { at, kind })
            }
            EntryContent::Message { error, text } => KeptRecord::Message {
                at,
                error,
                text: log.texts().get(text).to_owned(),
            },
        });
    }

    fn sample(&mut self, sample: Sample, log: &Log, out: &mut Vec<KeptRecord>) {
        if self.is_entry(sample.at, log) {
            return;
        }
        let Sample {
            at, frame, asked, ..
        } = sample;
        let model = self.marks.model(at, sample.model);
        let marks = model.into_iter().chain(self.marks.sample(&sample));
        let kind = LineEventKind::Received { frame, asked };
        let records = marks.chain([LineEvent { at, kind }]);
        out.extend(records.map(KeptRecord::Line));
    }

    /// Whether the sample of this time repeats an entry that was read, or that will be read. The log drops entries while
    /// it is read: their samples are all that is left.
    fn is_entry(&self, at: Instant, log: &Log) -> bool {
        let was_read = self.read_until.is_some_and(|until| at <= until);
        let oldest = log.entries().oldest();
        let will_be_read = oldest.is_some_and(|oldest| at >= oldest.at);
        was_read || will_be_read
    }
}

/// The oldest state of a range, if it is older than the next entry or sample: a state tells of what came with it.
fn next_state(log: &Log, range: &mut Range<u64>, until: Option<Instant>) -> Option<KeptRecord> {
    let states = log.states();
    range.start = range.start.max(states.numbers().start).min(range.end);
    let state = states.get(range.start).filter(|_| !range.is_empty())?;
    until.is_none_or(|until| state.at < until).then(|| {
        range.start += 1;
        KeptRecord::State {
            at: state.at,
            stored: state.stored.clone(),
        }
    })
}

/// The oldest value of a range that is still kept.
fn next<T: Copy>(values: &Chunks<T>, range: &mut Range<u64>) -> Option<T> {
    range.start = range.start.max(values.first()).min(range.end);
    values.get(range.start).filter(|_| !range.is_empty())
}

#[cfg(test)]
#[path = "kept_tests.rs"]
mod tests;
